// The text of a scenario: the library reads it, the controls change lines of it.

/** Strings, also of several lines, and comments. They may look like keys and tables. */
const STRING_OR_COMMENT = /"""(?:\\[^]|[^\\])*?"""|'''[^]*?'''|"(?:\\.|[^"\\\n])*"|'[^'\n]*'|#.*/g;
/** Keys and headers, in which each quoted name and each comment is masked by underscores. */
const PATH = String.raw`[\w-]+(?:\s*\.\s*[\w-]+)*`;
const HEADER = new RegExp(`^(\\s*\\[\\[?\\s*)(${PATH})\\s*\\]\\]?\\s*_*$`);
const KEY = new RegExp(`^(\\s*)(${PATH})\\s*=`);

/** Returns the names of a path, without their quotes and blanks, with dots in between. */
const plain = (path) => path.match(/"[^"]*"|'[^']*'|[\w-]+/g).map((name) => name.replace(/^["']|["']$/g, "")).join(".");

/** Returns the lines of a text, each with the path of its key or header, and the path of its table. An inline table is one line. */
function parsed(text) {
  const whole = text.replace(/\n*$/, "\n");
  const masked = whole.replace(STRING_OR_COMMENT, (part) => part.replace(/[^\n]/g, "_")).split("\n");
  let table = "";
  // Brackets of arrays that go on in the next line.
  let depth = 0;
  return whole.split("\n").map((line, index) => {
    const outside = depth > 0 ? "" : masked[index];
    const pathOf = (form) => {
      const [, before, path] = outside.match(form) ?? [];
      return path && plain(line.slice(before.length, before.length + path.length));
    };
    for (const bracket of masked[index].match(/[[\]{}]/g) ?? []) depth += "[{".includes(bracket) ? 1 : -1;
    const header = pathOf(HEADER);
    table = header ?? table;
    const key = pathOf(KEY);
    return { line, table, isHeader: header !== undefined, path: header ?? (key && (table ? `${table}.${key}` : key)) };
  });
}

/** Returns the text in which a table has another last name. */
function withName(text, table, name) {
  const rename = ({ line, path }) => (isWithin(path, table) ? line.replace(new RegExp(`\\b${table.split(".").at(-1)}\\b`), name) : line);
  return parsed(text).map(rename).join("\n");
}

/** Returns the text in which a pulse is of another kind. Keys that this does not have are removed. */
function withPulse(text, from, to) {
  const keysOf = (kind) => PULSES.find(([name]) => name === kind)?.[2] ?? [];
  const removed = keysOf(from).filter((key) => !keysOf(to).includes(key));
  const named = withName(text, `ground.${from}`, to);
  return removed.reduce((now, key) => withValue(now, `ground.${to}.${key}`, null), named);
}

/** Returns the tables of ground motions in a text, whether or not the library knows them. */
function groundTables(text) {
  const tables = parsed(text).map(({ path }) => path?.match(/^ground\.[^.]+/)?.[0]);
  return [...new Set(tables)].filter((table) => table && table !== "ground.right");
}

const isWithin = (path, table) => path === table || path?.startsWith(`${table}.`);

/** Returns true if controls can change a table: the text has it as a table, with dotted keys or as an inline table. */
const hasTable = (text, table) => parsed(text).some(({ path }) => isWithin(path, table));

/** Returns the text in which a key, given with its table, has a value; without a value the key is removed. */
function withValue(text, key, value) {
  const dot = key.lastIndexOf(".");
  const [table, name] = [key.slice(0, dot), key.slice(dot + 1)];
  const all = parsed(text);
  const given = all.findIndex(({ path, isHeader }) => path === key && !isHeader);
  const inline = all.findIndex(({ path, isHeader }) => path === table && !isHeader);
  const from = all.findIndex(({ path, isHeader }) => path === table && isHeader);
  const dotted = all.findLastIndex(({ path, isHeader }) => isWithin(path, table) && !isHeader);
  const now = all.map(({ line }) => line);
  if (given >= 0 && value === null) now.splice(given, 1);
  else if (given >= 0) now[given] = now[given].replace(/=\s*[^#]*?(\s*#.*)?$/, `= ${value}$1`);
  else if (inline >= 0) {
    const quoted = `["']?${name}["']?\\s*=`;
    const entry = new RegExp(`([{,]\\s*${quoted})[^,}]*`);
    if (value === null) now[inline] = now[inline].replace(new RegExp(`,\\s*${quoted}[^,}]*|${quoted}[^,}]*,?`), "");
    else if (entry.test(now[inline])) now[inline] = now[inline].replace(entry, `$1 ${value} `).replace(/ +,/, ",");
    else now[inline] = now[inline].replace(/,?\s*\}/, (end, at, line) => `${/\{\s*$/.test(line.slice(0, at)) ? " " : ", "}${name} = ${value} }`);
  } else if (value === null) return text;
  else if (from >= 0) {
    let to = from + 1;
    while (to < all.length && !all[to].isHeader) to += 1;
    now.splice(endOfTable(all, to), 0, `${name} = ${value}`);
  } else if (dotted >= 0) now.splice(dotted + 1, 0, now[dotted].replace(/("[^"]*"|'[^']*'|[\w-]+)\s*=.*/, `${name} = ${value}`));
  else now.push(`[${table}]`, `${name} = ${value}`, "");
  return now.join("\n");
}

/** Returns the end of a table before the line `to`: comments and empty lines before the next table belong to that. */
function endOfTable(all, to) {
  let end = to;
  while (end > 0 && /^\s*(#.*)?$/.test(all[end - 1].line)) end -= 1;
  return end;
}

/** Returns the text without some tables and the tables in them, and the lines that were removed. `place` takes the place of the first one. */
function withoutTables(text, tables, place) {
  const all = parsed(text);
  const isOld = (path) => tables.some((table) => isWithin(path, table));
  const kept = [];
  const removed = [];
  all.forEach(({ line, table, path, isHeader }, index) => {
    const next = all.findIndex((other, at) => at >= index && other.isHeader);
    const isEnd = !isHeader && index >= endOfTable(all, next < 0 ? all.length : next);
    if (isEnd || !(isOld(table) || isOld(path))) return kept.push(line);
    if (isHeader && !kept.includes(place)) kept.push(place);
    removed.push(line);
  });
  if (!kept.includes(place)) kept.push("", place);
  return { text: kept.join("\n"), removed: removed.join("\n") };
}

/** Returns the text in which the first of some tables is replaced by another text, and the others are removed. */
function withTable(text, tables, replacement) {
  const HERE = "\u0000";
  const now = withoutTables(text, tables, HERE).text;
  return now.replace(HERE, () => replacement.trimEnd()).replace(/\n{3,}/g, "\n\n").trimEnd() + "\n";
}

/** Returns the numbers of a scenario that another one has changed, as keys and values; null if they differ in more. Tables may be missing there. */
function changedNumbers(from, to, inside = "") {
  const changes = [];
  for (const [name, value] of Object.entries(to)) {
    const old = from[name];
    if (value === old) continue;
    if (typeof value === "number" && typeof old === "number") changes.push([inside + name, value]);
    else if (!value || !old || typeof value !== "object" || Array.isArray(value)) {
      if (JSON.stringify(value) !== JSON.stringify(old)) return null;
    } else {
      const deeper = changedNumbers(old, value, `${inside}${name}.`);
      if (!deeper) return null;
      changes.push(...deeper);
    }
  }
  return changes;
}
