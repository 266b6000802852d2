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

/** @type {(element: Element, attributes: object) => void} the same value again would cost a layout */
export function put(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (element.getAttribute(name) !== `${value}`) element.setAttribute(name, value);
  }
}

/** @type {(element: Element, text: string) => void} the same text again would cost a layout */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** @type {(parent: ParentNode, ...looks: string[]) => SVGElement[]} make a path of each class */
export function paths(parent, ...looks) {
  return looks.map((look) => draw(parent, "path", { class: look }));
}

/** @type {(parent: ParentNode, tag: string, attributes?: object) => SVGElement} made in a parent */
export function draw(parent, tag, attributes = {}) {
  const element = /** @type {SVGElement} */ (document.createElementNS(SVG, tag));
  put(element, attributes);
  parent.append(element);
  return element;
}
