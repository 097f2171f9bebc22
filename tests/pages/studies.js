// Every case has its words and its command; the nearest mark follows the pointer, and texts are legible at any width.
const text = (id) => document.getElementById(id).textContent;
const holder = document.getElementById('points');
data.commands.forEach((command, row) => {
  archrock.show(row);
  verify(text('command') === command, `${row}: ${text('command')}`);
  verify(text('case').includes('factor'), text('case'));
});
const shown = [...holder.querySelectorAll('.spot')].filter((spot) => spot.getBoundingClientRect().width > 0);
verify(shown.length === data.commands.length, `${shown.length} marks`);
const middle = (spot) => {
  const box = spot.getBoundingClientRect();
  return { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true };
};
const first = shown.find((spot) => spot.dataset.row === '0');
holder.dispatchEvent(new PointerEvent('pointermove', middle(first)));
verify(archrock.chosen() === 0, 'pointer');
holder.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true }));
verify(archrock.chosen() === 1, 'next');
verify(document.querySelectorAll('#rows tbody tr')[1].classList.contains('chosen'), 'row');
holder.dispatchEvent(new PointerEvent('pointermove', middle(first)));
verify(archrock.chosen() === 1, 'stays');
// Marks, their legend and the legend of the picture have one colour for an outcome.
const fillOf = (path) => getComputedStyle(path).fill;
const keyTexts = { survives: 'comes to rest', overturns: 'overturns', uncertain: 'uncertain whether it overturns' };
for (const key of document.querySelectorAll('.legend.marks .spot:not(:has(.outside))')) {
  const kind = key.classList[1];
  const fill = fillOf(key.querySelector('path'));
  for (const path of holder.querySelectorAll(`.spot.${kind}:not(.chosen) path:last-child`)) verify(fillOf(path) === fill, `${kind}: ${fillOf(path)}`);
  const words = [...holder.querySelectorAll('.wide text')].find((own) => own.textContent === keyTexts[kind]);
  const sign = words?.previousElementSibling.previousElementSibling;
  if (sign?.matches('rect')) verify(fillOf(sign) === fill, `${kind}: ${fillOf(sign)} in the legend of the picture`);
}
// No text is smaller than 12 px, and only tables are wider than the page.
for (const element of document.querySelectorAll('p, td, th, li, pre, svg text, button, h1, h2')) {
  const box = element.getBoundingClientRect();
  if (box.width === 0) continue;
  const svg = element.closest('svg[viewBox]');
  const scale = svg ? svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : 1;
  const size = parseFloat(getComputedStyle(element).fontSize) * scale;
  verify(size >= 12, `${size} px: ${element.textContent.slice(0, 40)}`);
}
verify(document.documentElement.scrollWidth <= innerWidth, `${document.documentElement.scrollWidth} px wide`);
verify(document.getElementById('command').scrollWidth <= document.getElementById('command').clientWidth + 1, 'cut command');

// In print there is no command, no table is cut, and a line says where the rows that are not printed are.
const rowsOf = (table) => [...table.tBodies[0].rows].filter((row) => row.getBoundingClientRect().height > 0);
const tables = [...document.querySelectorAll('.table')];
dispatchEvent(new Event('beforeprint'));
for (const id of ['command', 'copy']) verify(getComputedStyle(document.getElementById(id)).display === 'none', `${id} in print`);
tables.forEach((holder, index) => {
  const table = holder.querySelector('table');
  const { name, all } = archrock.data.tables[index];
  const printed = rowsOf(table).length;
  const note = holder.querySelector('.printed')?.textContent;
  const due = printed === 0 ? `${all} rows, all in ${name}` : `Rows 1 to ${printed} of ${all}, all in ${name}`;
  verify(printed === all ? note === undefined : note === due, `${name}, ${printed} rows: ${note}`);
  const [wide, room] = [table, holder.querySelector('.scroll')].map((box) => box.getBoundingClientRect().right);
  verify(wide <= room + 1, `${name} ends at ${wide} of ${room}`);
});
dispatchEvent(new Event('afterprint'));
for (const [index, holder] of tables.entries()) {
  const own = rowsOf(holder.querySelector('table')).length;
  verify(own === archrock.data.tables[index].rows.length && !holder.querySelector('.printed'), `${own} rows after print`);
}
