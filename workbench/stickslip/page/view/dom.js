/** Short words for what the page asks of its document. */

const SVG = "http://www.w3.org/2000/svg";

/**
 * The element of the page with this id.
 *
 * @param {string} id
 * @returns {any} of the class that its tag in the markup says
 */
export function byId(id) {
  return document.getElementById(id);
}

/**
 * Let something happen at an event of an element.
 *
 * @param {EventTarget} element
 * @param {string} type of the event
 * @param {(event: any) => void} act
 * @param {AddEventListenerOptions} [options]
 */
export function on(element, type, act, options) {
  element.addEventListener(type, act, options);
}

/**
 * Give an element these attributes; the same value again would cost a layout.
 *
 * @param {Element} element
 * @param {Record<string, any>} attributes texts and numbers by name
 */
export function put(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (element.getAttribute(name) !== `${value}`) element.setAttribute(name, value);
  }
}

/**
 * Give an element this text; the same text again would cost a layout.
 *
 * @param {Element} element
 * @param {string} text
 */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * Make an SVG element with these attributes inside a parent.
 *
 * @param {ParentNode} parent
 * @param {string} tag
 * @param {Record<string, string | number>} [attributes]
 */
export function draw(parent, tag, attributes = {}) {
  const element = document.createElementNS(SVG, tag);
  put(element, attributes);
  parent.append(element);
  return element;
}
