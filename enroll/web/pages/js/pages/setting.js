/* The dialog that changes one setting, with the input that fits what is allowed. */

import {_, _f} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {form, openDialog} from '../view/dialog.js';
import {choice, field, input} from '../view/fields.js';
import {notice, noticeFault} from '../view/notice.js';

/* What is allowed, from the words of the daemon: "a number, 0 to 1", "a whole number, 1 to 8", "a|b".
 * Numbers stay texts, so that they are shown as the daemon writes them. */
export function rangeOf(text) {
    const numbers = /^a (whole )?number, (-?[0-9.e+-]+) to (-?[0-9.e+-]+)$/.exec(text);
    if (numbers) {
        return { kind: 'number', whole: numbers[1] !== undefined, min: numbers[2], max: numbers[3] };
    }
    return text.includes('|') ? { kind: 'choice', words: text.split('|') } : { kind: 'text' };
}

function inputFor(one, range) {
    if (range.kind === 'choice') {
        return choice(range.words.map((word) => [word, word]), one.value, { autofocus: true });
    }
    if (range.kind === 'number') {
        return input({
            type: 'number',
            value: one.value,
            min: range.min,
            max: range.max,
            step: range.whole ? '1' : 'any',
            required: true,
            autofocus: true
        });
    }
    return input({ value: one.value, required: true, autofocus: true });
}

const code = (text) => h('code', {}, text === '' ? '–' : text);

/* Asks for another value and sets it. Resolves to true if something has changed. */
export async function changeSetting(api, one) {
    const range = rangeOf(one.range);
    const value = inputFor(one, range);
    const name = `${one.section}.${one.key}`;
    return await openDialog(_f('Change {name}', { name }), (close) => {
               const reset = async (event) => {
                   event.target.disabled = true;
                   try {
                       await api.resetSetting(one.section, one.key);
                       notice(_('The setting is as in the file again.'));
                       close(true);
                   } catch (error) {
                       noticeFault(error);
                       event.target.disabled = false;
                   }
               };
               return [
                   h('p', { lang: 'en', dir: 'ltr' }, one.help),
                   form(
                       [
                           field(
                               _('Value'), value,
                               range.kind === 'number' ? _f('From {min} to {max}', { min: range.min, max: range.max }) :
                                                         undefined),
                           h('dl', { class: 'facts' }, h('dt', {}, _('In the file')), h('dd', {}, code(one.configured)),
                             h('dt', {}, _('Default')), h('dd', {}, code(one.default))),
                           h('p', { class: 'quiet' }, _('It holds at once and after a restart, too.')),
                           one.value !== one.configured &&
                               h('p', {},
                                 h('button', { type: 'button', class: 'plain', onclick: reset }, _('As in the file'))),
                       ],
                       _('Save'), () => api.setSetting(one.section, one.key, value.value),
                       () => {
                           notice(_('The setting was changed.'));
                           close(true);
                       },
                       { cancel: () => close() }),
               ];
           }) === true;
}
