/* Fields of forms: a label, an input, and a line of help that screen readers connect with it. */

import {h, newId} from '../base/dom.js';
import {_} from '../base/i18n.js';
import {fromLocalInput, toLocalInput} from '../base/format.js';

/* A field around an input. */
export function field(label, input, help) {
    input.id ||= newId('field');
    const note = help && h('p', { id: newId('help'), class: 'help' }, help);
    if (note) {
        input.setAttribute('aria-describedby', note.id);
    }
    return h('div', { class: 'field' }, h('label', { for: input.id
             }, label), input, note);
}

export function input(attributes) { return h('input', { type: 'text', autocomplete: 'off', ...attributes }); }

/* A choice: options are [value, text] pairs. */
export function choice(options, value, attributes) {
    const element = h(
        'select', attributes, options.map(([key, text]) => h('option', { value: key, selected: key === value }, text)));
    element.value = value;
    return element;
}

export function checkbox(label, attributes) {
    const box = h('input', { type: 'checkbox', ...attributes });
    return { box, element: h('label', { class: 'check' }, box, h('span', {}, label)) };
}

/* Two fields for the limits of a person. read() returns seconds since 1970, 0 for no limit, or
 * throws an Error with a sentence. */
export function limits(fromS = 0, untilS = 0) {
    const from = input({ type: 'datetime-local', value: toLocalInput(fromS), max: '9999-12-31T23:59' });
    const until = input({ type: 'datetime-local', value: toLocalInput(untilS), max: '9999-12-31T23:59' });
    /* The field has no seconds: what was not touched stays as it was, to the second. */
    const value = (element, before) =>
        (element.value === toLocalInput(before) ? before : fromLocalInput(element.value));
    return {
        element:
            h('div', { class: 'pair' }, field(_('Valid from'), from, _('Empty: no limit')),
              field(_('Valid until'), until)),
        read() {
            const valid_from_s = value(from, fromS);
            const valid_until_s = value(until, untilS);
            if (!from.validity.valid || !until.validity.valid || Number.isNaN(valid_from_s + valid_until_s)) {
                throw new Error(_('A limit is not a complete time.'));
            }
            if (valid_from_s && valid_until_s && valid_from_s >= valid_until_s) {
                throw new Error(_('The end has to be after the beginning.'));
            }
            return { valid_from_s, valid_until_s };
        },
    };
}

/* A new password, typed twice. read() throws an Error with a sentence. */
export function newPassword(label) {
    const
        attributes = { type: 'password', autocomplete: 'new-password', required: true, minlength: 12, maxlength: 128 };
    const first = input(attributes);
    const second = input(attributes);
    return {
        elements: [field(label, first, _('At least 12 characters')), field(_('The same once more'), second)],
        read() {
            if (first.value !== second.value) {
                throw new Error(_('The two passwords are different.'));
            }
            return first.value;
        },
    };
}
