"""The style sheet of what is known, beside the page's own."""

SHEET = """<style>
.v-known .v-map{position:relative;border-radius:7px;overflow:hidden;background:var(--tile)}
.v-known .v-map img{display:block;width:100%}
.v-known .v-map b{position:absolute;font-size:13px;line-height:1;padding:3px 5px;
border-radius:4px;background:rgba(12,15,20,.78);color:#fff;font-weight:700}
.v-map .v-tl{left:5px;top:5px}.v-map .v-tr{right:5px;top:5px}
.v-map .v-bl{left:5px;bottom:5px}.v-map .v-br{right:5px;bottom:5px}
.v-map .v-mid{left:50%;top:50%;transform:translate(-50%,-50%)}
.v-scale{margin-top:6px}
.v-scale>div:first-child{height:11px;border-radius:3px;border:1px solid var(--line)}
.v-ticks{display:flex;justify-content:space-between;font-size:12px;color:var(--soft)}
.v-view img{display:block;width:100%;max-width:400px;border-radius:7px}
.v-what{width:100%;border-collapse:collapse;font-size:14px;margin-top:2px}
.v-what th{font-weight:600;color:var(--soft);font-size:12px;text-align:right;padding:2px 0 2px 8px}
.v-what td{border-top:1px solid var(--line);padding:3px 0 3px 8px;text-align:right;
white-space:nowrap}
.v-what td:first-child,.v-what th:first-child{text-align:left;padding-left:0;color:var(--soft);
white-space:normal}
.v-what td:last-child{font-weight:700}
.v-verdict{font-weight:650;margin-top:6px}
.v-row.v-param{display:block}
.v-param summary{display:grid;grid-template-columns:2.1em 1fr auto;column-gap:7px;
align-items:baseline;cursor:pointer;list-style:none}
.v-param summary::-webkit-details-marker{display:none}
.v-row.v-param .v-value{grid-column:2/3}
.v-row.v-param .v-spark{grid-column:3/4;justify-self:end;align-self:center}
.v-spark polyline{fill:none;stroke:var(--soft);stroke-width:1.6}
.v-spark circle{fill:var(--text)}
.v-does{font-size:13px;line-height:1.35;padding:2px 0 5px 2.6em;color:var(--text)}
.mantine-Modal-content .v-view h3:first-child{display:none}
.mantine-Modal-content:has(.v-view){flex:0 1 520px}
</style>"""
