/* Dialogs: a question, a form, a remark. They are <dialog> elements, so that the browser keeps the
 * focus inside and gives it back. */

import {_} from '../base/i18n.js';
import {append, fill, h, newId} from '../base/dom.js';
import {faultText} from '../transport/fault.js';

/* Opens a dialog with the contents that make(close) returns. close(value) closes it; Esc and another
 * page close it with undefined, unless `firm`. Returns a promise of the value. */
export function openDialog(title, make, {firm = false, wide = false} = {}) {
    return new Promise((resolve) => {
        const id = newId('dialog');
        const dialog = h('dialog', { 'aria-labelledby': id, class: wide ? 'wide' : '' });
        let value;
        const close = (result) => {
            value = result;
            dialog.close();
        };
        const leave = () => firm || close();
        addEventListener('hashchange', leave);
        append(dialog, [h('h2', { id }, title), make(close)]);
        dialog.addEventListener('cancel', (event) => {
            if (firm) {
                event.preventDefault();
            }
        });
        dialog.addEventListener('close', () => {
            if (firm && value === undefined) {
                dialog.showModal(); /* browsers let the second Esc through */
                return;
            }
            removeEventListener('hashchange', leave);
            dialog.remove();
            resolve(value);
        });
        document.body.append(dialog);
        dialog.showModal();
    });
}

/* Asks before something is done. `act` is what the button says. Resolves to true or false. */
export async function confirm(title, text, act, {danger = false} = {}) {
    return await openDialog(
               title,
               (close) =>
                   [h('p', {}, text),
                    h('div', { class: 'buttons' },
                      h('button', { type: 'button', class: 'plain', autofocus: true, onclick: () => close(false) },
                        _('Cancel')),
                      h('button', { type: 'button', class: danger ? 'danger' : '', onclick: () => close(true) }, act)),
    ]) === true;
}

/* A place for the fault of a form; it is read aloud when it gets a text. */
export function faultLine() { return h('p', { class: 'fault', role: 'alert' }); }

/* A form that sends its values once and shows what went wrong. send() does the work and may throw a
 * Fault, or an Error with a sentence. What was typed stays. `after(result)` follows a success. */
export function form(fields, act, send, after, {cancel, danger = false} = {}) {
    const fault = faultLine();
    const button = h('button', { type: 'submit', class: danger ? 'danger' : '' }, act);
    const element =
        h('form', { novalidate: false }, ...fields, fault,
          h('div', { class: 'buttons' },
            cancel && h('button', { type: 'button', class: 'plain', onclick: cancel }, _('Cancel')), button));
    element.addEventListener('submit', async (event) => {
        event.preventDefault();
        if (button.disabled) {
            return;
        }
        button.disabled = true;
        fill(fault);
        try {
            after(await send());
        } catch (error) {
            fill(fault, faultText(error));
        } finally {
            button.disabled = false;
        }
    });
    return element;
}
