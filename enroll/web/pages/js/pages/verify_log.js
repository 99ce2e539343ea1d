/* The button that checks every record of the log, and its result in words. */

import {_, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {number} from '../base/format.js';
import {faultText} from '../transport/fault.js';
import {openDialog} from '../view/dialog.js';

function result(found) {
    const range = { first: number(found.first), last: number(found.last) };
    if (found.sound) {
        return [
            h('p', { class: 'good' }, '✓ ', _f('The records {first} to {last} are complete and unchanged.', range)),
            h('p', {}, _('Keep this check sum elsewhere. It proves later that the log was not replaced:')),
            h('p', {}, h('code', { class: 'long' }, found.head ?? ''))
        ];
    }
    return [
        h('p', { class: 'fault' }, '✕ ',
          _f('The log was changed or damaged at record {n}.', { n: number(found.flaw_at) })),
        h('p', { lang: 'en' }, found.flaw ?? '')
    ];
}

export function verifyButton(api) {
    const verify = () => openDialog(_('Verification of the log'), (close) => {
        const place =
            h('div', { role: 'status' }, h('p', {}, _('Every record is being checked…')),
              h('progress', { 'aria-label': _('Progress') }));
        api.verifyLog().then(
            (found) => fill(place, result(found)),
            (error) => fill(place, h('p', { class: 'fault' }, faultText(error))));
        return [
            place, h('div', { class: 'buttons' }, h('button', { type: 'button', onclick: () => close() }, _('Close')))
        ];
    });
    return h('button', { type: 'button', class: 'plain', onclick: verify }, _('Verify the log'));
}
