/* Short remarks at the lower edge of the page, which go away by themselves. Screen readers read
 * them aloud. */

import {h} from '../base/dom.js';
import {faultText} from '../transport/fault.js';

const SHOWN_MS = 6000;
const place = h('div', { class: 'notices', role: 'status', 'aria-live': 'polite' });

/* The place of the remarks, which is in the page once. */
export function noticePlace() { return place; }

export function notice(text, kind = '') {
    const line = h('p', { class: kind }, text);
    place.append(line);
    setTimeout(() => line.remove(), SHOWN_MS);
}

/* Says what went wrong. */
export function noticeFault(error) {
    if (error?.name !== 'AbortError') {
        notice(faultText(error), 'bad');
    }
}
