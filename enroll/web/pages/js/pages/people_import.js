/* The import of a CSV file: it shows first what would change, then changes person by person. */

import {_, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {limit, number} from '../base/format.js';
import {planImport} from '../base/people_csv.js';
import {IMPORT_FLAWS, word} from '../base/words.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {openDialog} from '../view/dialog.js';
import {chooseFile} from '../view/file.js';

const MOST_BYTES = 16 << 20;
const ROWS_MOST = 500; /* shown; all are counted */

function kinds() {
    return {
        change: ['odd', _('changes')],
        unchanged: ['plain', _('unchanged')],
        missing: ['plain', _('not enrolled here')],
        invalid: ['bad', _('invalid')],
    };
}

function changeText({ person, change }) {
    const cards = (list) => h('bdi', {}, list.join(' ') || '–');
    return [
        ...[['valid_from_s', _('Valid from')], ['valid_until_s', _('Valid until')]]
            .filter(([key]) => change[key] !== person[key])
            .map(([key, name]) => h('div', {}, name, ': ', limit(person[key]), ' → ', limit(change[key]))),
        change.cards && h('div', {}, _('Cards'), ': ', cards(person.cards), ' → ', cards(change.cards)),
    ];
}

function planTable(plan) {
    const texts = kinds();
    const order = ['invalid', 'change', 'missing', 'unchanged'];
    const rows =
        plan.toSorted((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind) || a.line - b.line).slice(0, ROWS_MOST);
    const head = (text) => h('th', { scope: 'col' }, text);
    return h(
        'div', { class: 'scroll tall', tabindex: 0 },
        h('table', {},
          h('thead', {}, h('tr', {}, head(_('Line')), head(_('Name')), head(_('What happens')), head(_('Details')))),
          h('tbody', {},
            rows.map(
                (row) =>
                    h('tr', {}, h('td', { class: 'number' }, row.line), h('td', {}, h('bdi', {}, row.name)),
                      h('td', {}, badge(...texts[row.kind])),
                      h('td', {},
                        row.kind === 'invalid' ? word(IMPORT_FLAWS, row.why) :
                                                 row.kind === 'change' && changeText(row)))))));
}

async function applyOne(api, { name, person, change }) {
    const { cards, ...times } = change;
    if (times.valid_from_s !== person.valid_from_s || times.valid_until_s !== person.valid_until_s) {
        await api.changePerson(name, {...times, ...(times.valid_until_s ? { expired: true } : {}) });
    }
    if (cards) {
        await api.changeCredential(name, { cards });
    }
}

/* Changes one person after the other; a failure stops nobody else. */
async function apply(api, changes, progress, stopped) {
    const failed = [];
    let done = 0;
    for (const row of changes) {
        if (stopped()) {
            break;
        }
        try {
            await applyOne(api, row);
        } catch (error) {
            failed.push([row.name, faultText(error)]);
            if (['login-required', 'no-connection', 'no-daemon', 'not-allowed'].includes(error.code)) {
                break; /* the others would fail, too */
            }
        }
        done += 1;
        progress(done);
    }
    return { changed: done - failed.length, failed, left: changes.length - done };
}

function work(api, plan, close, after) {
    const changes = plan.filter((row) => row.kind === 'change');
    const bar = h('progress', { max: changes.length || 1, value: 0, 'aria-label': _('Progress'), hidden: true });
    const result = h('div', { role: 'status' });
    let running = false;
    let stop = false;
    const cancel =
        h('button', {
            type: 'button',
            class: 'plain',
            onclick: () => {
                stop = true;
                if (!running) {
                    close();
                }
            }
        },
          _('Close'));
    const begin =
        h('button', {
            type: 'button',
            disabled: changes.length === 0,
            onclick: async () => {
                running = true;
                begin.disabled = true;
                bar.hidden = false;
                say(cancel, _('Stop the import'));
                const end = await apply(api, changes, (done) => {
                    bar.value = done;
                }, () => stop);
                running = false;
                say(cancel, _('Close'));
                fill(
                    result,
                    h('p', {},
                      _f('Changed: {changed}. Failed: {failed}. Not tried: {left}.',
                         { changed: number(end.changed), failed: number(end.failed.length), left: number(end.left) })),
                    end.failed.length > 0 &&
                        h('ul', { class: 'fault' },
                          end.failed.map(([name, why]) => h('li', {}, h('bdi', {}, name), `: ${why}`))));
                after();
            }
        },
          _f('Change people: {n}', { n: number(changes.length) }));
    return [bar, result, h('div', { class: 'buttons' }, cancel, begin)];
}

/* Asks for a file and imports it; after() is called when people were changed. */
export async function importPeople(api, people, after) {
    const file = await chooseFile('.csv,text/csv');
    if (!file) {
        return;
    }
    let plan;
    let flaw = file.size > MOST_BYTES ? _('The file is too large.') : '';
    try {
        plan = flaw ? [] : planImport(await file.text(), people);
    } catch (error) {
        flaw = word(IMPORT_FLAWS, error.message);
    }
    await openDialog(_f('Import {file}', { file: file.name }), (close) => {
        if (flaw) {
            return [
                h('p', { class: 'fault', role: 'alert' }, flaw),
                h('div', { class: 'buttons' }, h('button', { type: 'button', onclick: () => close() }, _('Close')))
            ];
        }
        const texts = kinds();
        const counts = Object.keys(texts).map((kind) => [kind, plan.filter((row) => row.kind === kind).length]);
        return [
            h('p', {},
              _('An import changes only the limits and cards of people who are enrolled here. It enrols and removes nobody.')),
            h('ul', { class: 'counts' },
              counts.map(([kind, n]) => h('li', {}, badge(...texts[kind]), ` ${number(n)}`))),
            planTable(plan),
            plan.length > ROWS_MOST &&
                h('p', { class: 'quiet' }, _f('The first {n} rows are shown.', { n: number(ROWS_MOST) })),
            ...work(api, plan, close, after)
        ];
    }, { wide: true });
}
