/* What only the browser knows of its window: its height, and whether its person wants less motion, in
   cookies that come with the connection (window.py); the height, when it has changed, in fields too
   (panels.py); where the scene is in it, for what stands at the scene's lower edge (style.css). And a
   film strip shows its newest picture, and is scrolled by a wheel. */
(() => {
  const SCENE = "div:has(> div > div > canvas[data-engine])";
  const PICTURE = "div:has(> .v-film) + div button";
  const told = document.documentElement.style;

  const tellHeight = () => {
    document.cookie = `venus3d-window-height=${innerHeight}; path=/; SameSite=Strict`;
  };
  tellHeight();
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches ? 1 : 0;
  document.cookie = `venus3d-reduced-motion=${calm}; path=/; SameSite=Strict`;

  /* Written as a person would type it; with the time, since React passes over an equal text. */
  const typed = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set;
  let settling = 0;
  const tellFields = tries => {
    const fields = document.querySelectorAll("div:has(> .v-window-height) + div input");
    /* Resized while the page was still coming, after its connection had told the height. */
    if (!fields.length && tries) settling = setTimeout(tellFields, 500, tries - 1);
    for (const field of fields) {
      typed.call(field, `${innerHeight} ${Math.round(performance.now())}`);
      field.dispatchEvent(new Event("input", { bubbles: true }));
    }
  };
  addEventListener("resize", () => {
    tellHeight();
    clearTimeout(settling);
    settling = setTimeout(tellFields, 200, 60);
  });

  /* Who has scrolled back from the newest picture looks at another, and keeps it when one comes or
     the strip gets another width. The strip scrolls by itself too, as a picture slides in: only
     leftwards counts, and only soon after a person's wheel, pointer or key. */
  const SOON_MS = 1500;
  let newest = true, before = 0, touched = -Infinity;
  const atEnd = strip => strip.scrollLeft + strip.clientWidth >= strip.scrollWidth - 2;
  for (const kind of ["wheel", "pointerdown", "keydown"]) {
    addEventListener(kind, ({ target, timeStamp }) => {
      if (document.querySelector(PICTURE)?.parentElement.contains(target)) touched = timeStamp;
    }, { capture: true, passive: true });
  }
  addEventListener("scroll", ({ target }) => {
    if (!target.matches?.(":has(> button)") || !target.querySelector(PICTURE)) return;
    if (atEnd(target)) newest = true;
    else if (target.scrollLeft < before && performance.now() - touched < SOON_MS) newest = false;
    before = target.scrollLeft;
  }, true);
  const showNewest = () => {
    const strip = document.querySelector(PICTURE)?.parentElement;
    if (strip && newest) strip.scrollLeft = strip.scrollWidth;
  };

  const waiting = new MutationObserver(() => {
    const scene = document.querySelector(SCENE)?.parentElement;
    if (!scene) return;
    waiting.disconnect();
    new ResizeObserver(() => {
      const { left, width } = scene.getBoundingClientRect();
      told.setProperty("--scene-left", `${left}px`);
      told.setProperty("--scene-width", `${width}px`);
      showNewest();
    }).observe(scene);
  });
  waiting.observe(document, { childList: true, subtree: true });

  addEventListener("animationstart", ({ animationName }) => {
    if (animationName === "v-film-in") showNewest();
  });

  /* Most mice have one wheel. */
  addEventListener("wheel", ({ target, deltaY }) => {
    const picture = target.closest?.(PICTURE);
    if (!picture) return;
    const strip = picture.parentElement;
    strip.scrollLeft += deltaY;
    newest = atEnd(strip);
  }, { passive: true });
})();
