/* A word with a colour and a sign, so that colour is never the only difference. */

import {h} from '../base/dom.js';

const SIGNS = {
    good: '✓',
    bad: '✕',
    odd: '!',
    plain: ''
};

export function badge(kind, text) {
    return h(
        'span', { class: `badge ${kind}` },
        SIGNS[kind] && h('span', { class: 'sign', 'aria-hidden': 'true' }, SIGNS[kind]), text);
}
