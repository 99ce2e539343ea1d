/* The dialogs that change the policy: hours of a schedule, dates of special days, the document. */

import {_, _f, languageTag} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {DAYS, readDates, readPeriods, textOf, weekOf, withDates, withHours} from '../base/policy.js';
import {word} from '../base/words.js';
import {POLICY_FLAWS} from '../base/words_policy.js';
import {form, openDialog} from '../view/dialog.js';
import {field, input} from '../view/fields.js';
import {notice} from '../view/notice.js';

/* Reads a field; the flaw is an Error with a sentence that names the field. */
function readField(read, text, label) {
    try {
        return read(text);
    } catch (error) {
        throw new Error(`${label}: ${word(POLICY_FLAWS, error.message)}`);
    }
}

/* The name of day `i`, Monday first. */
export function longDay(i) {
    return new Intl.DateTimeFormat(languageTag(), { weekday: 'long', timeZone: 'UTC' })
        .format(new Date(Date.UTC(2024, 0, 1 + i)));
}

/* Opens a dialog with a form. make() returns {elements, read}; what read() returns is stored. The page
 * is then drawn anew, and store.focus() gives the focus back to its button. */
async function edit(title, store, make, wide = false) {
    const result = await openDialog(title, (close) => {
        const { elements, read } = make();
        return form(elements, _('Store'), async () => store(read()), () => close('stored'), { cancel: () => close() });
    }, { wide });
    if (result === 'stored') {
        notice(_('The policy is stored and in force.'));
        store.focus();
    }
    return result === 'stored';
}

export function editHours(document, schedule, store) {
    return edit(_f('Hours of {name}', { name: schedule.token }), store, () => {
        const week = weekOf(schedule);
        const inputs = DAYS.map((_day, i) => input({ value: week[i].join(', '), dir: 'ltr', spellcheck: 'false' }));
        return {
            elements: [
                h('p', { class: 'help' },
                  _f('Periods by the clock of {zone}, such as 09:00-12:00, 13:00-17:30. An empty day has no hours.',
                     { zone: schedule.zone })),
                inputs.map((one, i) => field(longDay(i), one))
            ],
            read: () => withHours(
                document, schedule.token, inputs.map((one, i) => readField(readPeriods, one.value, longDay(i)))),
        };
    });
}

export function editDates(document, group, store) {
    return edit(_f('Dates of {name}', { name: group.token }), store, () => {
        const area = h('textarea', { rows: 10, dir: 'ltr', spellcheck: 'false' }, group.days.join('\n'));
        const label = _('Dates');
        return {
            elements: [field(label, area, _('One date on each line, such as 2026-12-25'))],
            read: () => withDates(document, group.token, readField(readDates, area.value, label)),
        };
    });
}

/* The whole document as text. */
export function editDocument(document, store) {
    return edit(_('The policy as JSON'), store, () => {
        const area = h('textarea', { rows: 18, dir: 'ltr', spellcheck: 'false', class: 'code' }, textOf(document));
        return {
            elements: [
                field(
                    _('Document'), area,
                    _('The manual page isotherm-policy(5) describes all members. The door service checks the document before it stores it.'))
            ],
            read() {
                try {
                    return JSON.parse(area.value);
                } catch (error) {
                    throw new Error(_f('This is no JSON: {reason}', { reason: error.message }));
                }
            },
        };
    }, true);
}
