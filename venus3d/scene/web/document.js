// Turns the exported lesson's pages and judges answers; html_document.py fills the capitals in.
const read = id => JSON.parse(document.getElementById(id).textContent);
const player = read('player'), recordings = read('recordings');
const pages = [...document.querySelectorAll('article')], frame = document.getElementById('scene');
let shown = -1;
function show(page) {
  if (page < 0 || page >= pages.length || page === shown) return;
  shown = page;
  pages.forEach((element, i) => { element.hidden = i !== page; });
  window.recording = recordings[page];
  const given = '<script>' + GIVEN + '<' + '/script><style>' + STYLE + '</style>';
  const at = player.indexOf('</head>');
  frame.srcdoc = player.slice(0, at) + given + player.slice(at);
  document.querySelectorAll('button[data-go]').forEach(button => {
    const to = page + Number(button.dataset.go);
    button.disabled = to < 0 || to >= pages.length;
  });
}
document.addEventListener('click', event => {
  const button = event.target.closest('button');
  if (!button) return;
  if (button.dataset.go) { show(shown + Number(button.dataset.go)); scrollTo(0, 0); }
  if (button.dataset.answer) {
    const question = button.closest('.question');
    question.querySelectorAll('[data-answer]').forEach(each => {
      each.classList.toggle('v-right', each.dataset.answer === '1');
      each.classList.toggle('v-wrong', each === button && each.dataset.answer === '0');
    });
    question.querySelectorAll('[data-verdict]').forEach(verdict => {
      verdict.hidden = verdict.dataset.verdict !== button.dataset.answer;
    });
  }
});
document.addEventListener('keydown', event => {
  if (event.key === 'PageDown') { show(shown + 1); event.preventDefault(); }
  if (event.key === 'PageUp') { show(shown - 1); event.preventDefault(); }
});
show(0);
