"""A button in a panel's HTML that copies a text."""

from __future__ import annotations

from html import escape

from venus3d.scene.web import texts

# navigator.clipboard exists on localhost and https only; elsewhere the selection is copied.
_COPY = (
    "const t=this.dataset.copy,b=this;"
    "const done=()=>{b.dataset.done='1';setTimeout(()=>delete b.dataset.done,1500)};"
    "const old=()=>{const a=document.createElement('textarea');a.value=t;"
    "document.body.append(a);a.select();document.execCommand('copy');a.remove();done()};"
    "navigator.clipboard?navigator.clipboard.writeText(t).then(done,old):old()"
)


def copy_button(text: str, label: str = "", hint: str = "") -> str:
    """A button that copies `text`; without a `label` a small one, to stand beside a number."""
    hint = hint or texts.COPY_HINT
    shown = f"<span>{escape(label)}</span>" if label else ""
    return (
        f"<button class='v-copy' type='button' title='{escape(hint)}' "
        f"aria-label='{escape(label or hint)}' data-copy='{escape(text)}' "
        f'onclick="{_COPY}">{shown}</button>'
    )
