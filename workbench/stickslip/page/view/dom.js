/** Short words for what the page asks of its document. */

const SVG = "http://www.w3.org/2000/svg";

/** @type {(id: string) => any} the element with this id, of the class that its tag says */
export function byId(id) {
  return document.getElementById(id);
}

/** What Python hands to the page. */
export const data = JSON.parse(byId("page-data").textContent);

/** @type {(element: EventTarget, type: string, act: (event: any) => void, options?: any) => void} */
export function on(element, type, act, options) {
  element.addEventListener(type, act, options);
}

/**
 * Give an element these attributes; the same value again would cost a layout.
 * @type {(element: Element, attributes: Record<string, any>) => void}
 */
export function put(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (element.getAttribute(name) !== `${value}`) element.setAttribute(name, value);
  }
}

/**
 * Give an element this text; the same text again would cost a layout.
 * @type {(element: Element, text: string) => void}
 */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** @type {(parent: ParentNode, ...looks: string[]) => SVGElement[]} make a path of each class */
export function paths(parent, ...looks) {
  return looks.map((look) => draw(parent, "path", { class: look }));
}

/**
 * Make an SVG element with these attributes inside a parent.
 * @type {(parent: ParentNode, tag: string, attributes?: Record<string, any>) => SVGElement}
 */
export function draw(parent, tag, attributes = {}) {
  const element = /** @type {SVGElement} */ (document.createElementNS(SVG, tag));
  put(element, attributes);
  parent.append(element);
  return element;
}
