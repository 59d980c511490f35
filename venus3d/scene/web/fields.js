/* Keys belong to the page again once a field is done with: after a choice, Enter or Esc, and after a
   key that a number cannot contain, which the page then gets. While a field has them, the page says
   so. The browser sends keys to the element that has the focus, and viser hears none from a field.
   A folder is unfolded by Enter or the space bar as well. In a number a comma is a point. */
(() => {
  const FIELD = "input, textarea";
  const TICKED = "input[type=checkbox], input[type=radio]";
  const NUMBER = ".mantine-NumberInput-input";
  const OTHERS = "[class*=Spotlight]";
  const FOLDER = ".mantine-Paper-root[data-with-border] > .mantine-Paper-root[style*='cursor: pointer']";
  let note = null;

  const field = () => {
    const active = document.activeElement;
    return active?.matches(FIELD) && !active.closest(OTHERS) ? active : null;
  };

  function release() {
    // The widget's own listeners come first.
    setTimeout(() => field()?.blur());
  }

  function tell() {
    const active = field(), said = document.querySelector("[data-typing]")?.dataset.typing;
    const on = said && active && !active.matches(TICKED);
    if (!on) {
      note?.remove();
      note = null;
    } else if (!note) {
      note = document.createElement("div");
      note.className = "v-typing";
      note.setAttribute("role", "status");
      note.textContent = said;
      document.body.append(note);
    }
  }

  addEventListener("keydown", (event) => {
    const active = field();
    if (!active) return;
    if (event.key === "Enter" || event.key === "Escape") {
      release();
    } else if (active.matches(NUMBER) && event.key.length === 1 && !/[\d.,+-]/.test(event.key)
               && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      event.stopImmediatePropagation();
      active.blur();
      const { key, code, shiftKey } = event;
      document.body.dispatchEvent(
        new KeyboardEvent("keydown", { key, code, shiftKey, bubbles: true, cancelable: true }),
      );
    }
  }, true);
  // viser's folders are unfolded by the mouse only.
  addEventListener("keydown", (event) => {
    if (event.key === "Tab") {
      for (const header of document.querySelectorAll(`${FOLDER}:not([tabindex])`)) {
        header.tabIndex = 0;
        header.setAttribute("role", "button");
      }
    } else if ((event.key === "Enter" || event.key === " ") && event.target.matches?.(FOLDER)) {
      event.preventDefault();
      event.stopImmediatePropagation();
      event.target.click();
    }
  }, true);
  // A field leaves the comma of a pasted number out: "12,5" was 125.
  addEventListener("beforeinput", (event) => {
    if (!event.target.matches?.(NUMBER) || !event.data?.includes(",")) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    document.execCommand("insertText", false, event.data.replaceAll(",", "."));
  }, true);
  addEventListener("change", (event) => event.target.matches?.(TICKED) && release());
  addEventListener("click", (event) => event.target.closest?.("[role=option]") && release());
  addEventListener("focusin", tell);
  addEventListener("focusout", () => setTimeout(tell));
})();
