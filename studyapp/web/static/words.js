// What scripts say, in the language of the page. The English texts are the keys.

const page = document.documentElement.lang || "en";
const catalogue = JSON.parse(document.getElementById("words")?.content || "{}");
const plurals = new Intl.PluralRules(page);
const lists = new Intl.ListFormat(page === "en" ? "en-GB" : page, { type: "conjunction" });

function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (place, name) => values[name] ?? place);
}

// `text` with its {places} filled.
export function say(text, values = {}) {
  return filled(catalogue[text] ?? text, values);
}

// The form for `count` things; {count} stands for the number.
export function sayCount(one, many, count, values = {}) {
  const forms = catalogue[one] ?? { one, other: many };
  return filled(forms[plurals.select(count)] ?? forms.other, { count, ...values });
}

// a, b and c
export function listed(texts) {
  return lists.format(texts);
}
