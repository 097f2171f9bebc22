// The data of a page, which are in #data, and the colours of its style.
const find = (id) => document.getElementById(id);
const data = JSON.parse(find("data").textContent);
const buffer = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const farthest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value ?? 0)), 0);
