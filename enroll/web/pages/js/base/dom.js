/* Builds elements. A text is always a text node, so that a name or a word of the daemon can never
 * become markup: no module sets markup from a text. */

const SVG = 'http://www.w3.org/2000/svg';

/* Adds children: elements, texts, and lists of them; null, undefined and false are left out. */
export function append(element, children) {
    for (const child of [children].flat(Infinity)) {
        if (child === null || child === undefined || child === false) {
            continue;
        }
        element.append(child instanceof Node ? child : String(child));
    }
    return element;
}

function set(element, attributes) {
    for (const [name, value] of Object.entries(attributes ?? {})) {
        if (name.startsWith('on')) {
            element.addEventListener(name.slice(2), value);
        } else if (value === true) {
            element.setAttribute(name, '');
        } else if (value !== false && value !== null && value !== undefined) {
            element.setAttribute(name, String(value));
        }
    }
    return element;
}

/* Makes an element of HTML. An attribute such as "onclick" adds a listener. The value true sets an
 * attribute without a value. An attribute with the value false, null or undefined is left out. */
export function h(tag, attributes, ...children) {
    return append(set(document.createElement(tag), attributes), children);
}

/* Makes an element of SVG in the same way. */
export function svg(tag, attributes, ...children) {
    return append(set(document.createElementNS(SVG, tag), attributes), children);
}

/* Replaces all that an element contains. */
export function fill(element, ...children) {
    element.replaceChildren();
    return append(element, children);
}

/* Sets the text of an element only if it changes: a live region would read it aloud again. */
export function say(element, text) {
    if (element.textContent !== text) {
        element.textContent = text;
    }
}

let ids = 0;

/* An id that no other element has. */
export function newId(prefix) {
    ids += 1;
    return `${prefix}-${ids}`;
}
