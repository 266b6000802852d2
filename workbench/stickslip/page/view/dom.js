/** Short words for what the page asks of its document. */

const SVG = "http://www.w3.org/2000/svg";

/** The element of the page with this id. */
export function byId(id) {
  return document.getElementById(id);
}

/** Let something happen at an event of an element; options as addEventListener has them. */
export function on(element, type, act, options) {
  element.addEventListener(type, act, options);
}

/** Give an element these attributes; the same value again would cost a layout. */
export function put(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (element.getAttribute(name) !== `${value}`) element.setAttribute(name, value);
  }
}

/** Give an element this text; the same text again would cost a layout. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Make an SVG element with these attributes inside a parent. */
export function draw(parent, tag, attributes = {}) {
  const element = document.createElementNS(SVG, tag);
  put(element, attributes);
  parent.append(element);
  return element;
}
