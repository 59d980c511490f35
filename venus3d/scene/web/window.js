/* What only the browser knows of its window: its height, in a cookie that comes with the connection
   and, when it has changed, in fields (panels.py); where the scene is in it, for what stands at the scene's lower edge (style.css). And a
   film strip shows its newest picture, and is scrolled by a wheel. */
(() => {
  const SCENE = "div:has(> div > div > canvas[data-engine])";
  const told = document.documentElement.style;

  const tellHeight = () => {
    document.cookie = `venus3d-window-height=${innerHeight}; path=/; SameSite=Strict`;
  };
  tellHeight();

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

  const waiting = new MutationObserver(() => {
    const scene = document.querySelector(SCENE)?.parentElement;
    if (!scene) return;
    waiting.disconnect();
    new ResizeObserver(() => {
      const { left, width } = scene.getBoundingClientRect();
      told.setProperty("--scene-left", `${left}px`);
      told.setProperty("--scene-width", `${width}px`);
    }).observe(scene);
  });
  waiting.observe(document, { childList: true, subtree: true });

  addEventListener("animationstart", ({ animationName, target }) => {
    if (animationName !== "v-film-in") return;
    const strip = target.parentElement, before = target.previousElementSibling;
    /* Who has scrolled away from the newest one looks at another. */
    if (before && before.offsetLeft > strip.scrollLeft + strip.clientWidth) return;
    strip.scrollLeft = target.offsetLeft + target.offsetWidth - strip.clientWidth;
  });

  /* Most mice have one wheel. */
  addEventListener("wheel", ({ target, deltaY }) => {
    const picture = target.closest?.("div:has(> .v-film) + div button");
    if (picture) picture.parentElement.scrollLeft += deltaY;
  }, { passive: true });
})();
