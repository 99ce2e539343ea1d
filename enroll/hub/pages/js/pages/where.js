/* The page Who was where: the records of the logs of all doors, the newest first. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {fromLocalInput, number} from '../base/format.js';
import {writeCsv} from '../base/csv.js';
import {word} from '../base/words.js';
import {EVENTS} from '../base/words_log.js';
import {faultText} from '../transport/fault.js';
import {datedName, download} from '../view/download.js';
import {choice, field, input} from '../view/fields.js';
import {stack} from '../view/stack.js';
import {recordCells, recordRow} from './record_row.js';

const PAGE = 200;

/* The form of a record's time; undefined for no time. */
function recordTime(element) {
    const seconds = fromLocalInput(element.value);
    return seconds > 0 ? new Date(seconds * 1000).toISOString() : undefined;
}

function heads() { return [_('Door'), _('Number'), _('Time'), _('Event'), _('Person'), _('Verdict'), _('Details')]; }

const plain = ({ record, number: sequence, time }) => ({ sequence, time, ...record });

function makeRow(event) {
    const row = recordRow(plain(event));
    row.prepend(h('td', {}, h('bdi', {}, event.door.name)));
    return row;
}

function make({ api, hub }) {
    const state = { events: [], next: null, turn: 0 };
    const body = h('tbody', {});
    const fault = h('p', { class: 'fault', role: 'alert' });
    const status = h('p', { class: 'quiet', role: 'status' });
    const person = input({ type: 'search', spellcheck: 'false' });
    const door = h('select', {}, h('option', { value: '' }, _('All doors')));
    const kind = choice([['', _('All events')], ...Object.keys(EVENTS).map((key) => [key, word(EVENTS, key)])], '');
    const from = input({ type: 'datetime-local' });
    const until = input({ type: 'datetime-local' });
    const older =
        h('button', { type: 'button', class: 'plain', hidden: true, onclick: () => load(false) }, _('Load older'));

    async function load(anew) {
        state.turn += 1;
        const { turn } = state;
        older.disabled = true;
        try {
            const { events, next } = await api.events({
                door: door.value,
                person: person.value.trim(),
                event: kind.value,
                since: recordTime(from),
                until: recordTime(until),
                before: anew ? undefined : state.next,
                max: PAGE
            });
            if (turn !== state.turn) {
                return;
            }
            const rows = events.map(makeRow);
            if (anew) {
                fill(body, rows);
                state.events = events;
            } else {
                body.append(...rows);
                state.events.push(...events);
            }
            state.next = next;
            older.hidden = next === null;
            say(status,
                _f('Shown: {n}', { n: number(state.events.length) }) +
                    (next === null ? ` · ${_('This is the beginning.')}` : ''));
            fill(fault);
        } catch (error) {
            fill(fault, faultText(error));
        } finally {
            older.disabled = false;
        }
    }

    async function loadDoors() {
        try {
            fill(
                door, h('option', { value: '' }, _('All doors')),
                (await api.doors()).map(({ id, name }) => h('option', { value: id }, name)));
        } catch {
            /* the list says what is wrong */
        }
    }

    let timer = 0;
    for (const element of [person, door, kind, from, until]) {
        element.addEventListener(element === person ? 'input' : 'change', () => {
            clearTimeout(timer);
            timer = setTimeout(() => load(true), element === person ? 300 : 0);
        });
    }
    const save = () => download(
        datedName('fleet-events'),
        writeCsv([heads(), ...state.events.map((event) => [event.door.name, ...recordCells(plain(event), true)])]));
    loadDoors();
    load(true);
    const end = hub.on('connection', (up) => up && load(true));
    return {
        element:
            h('div', {},
              h('div', { class: 'bar fields' }, field(_('Person'), person, _('The exact name')), field(_('Door'), door),
                field(_('Event'), kind), field(_('From'), from), field(_('Until'), until)),
              h('div', { class: 'bar' },
                h('button', { type: 'button', class: 'plain', onclick: () => load(true) }, _('Load again')),
                h('button', { type: 'button', class: 'plain', onclick: save }, _('Download CSV'))),
              fault,
              h('div', { class: 'panel scroll', tabindex: 0, role: 'region', 'aria-label': _('Who was where') },
                stack(
                    h('table', { class: 'log' }, h('caption', { class: 'unseen' }, _('Who was where')),
                      h('thead', {}, h('tr', {}, heads().map((text) => h('th', { scope: 'col' }, text)))), body))),
              status, h('div', { class: 'buttons start' }, older)),
        resume: () => load(true),
        leave() {
            state.turn += 1;
            clearTimeout(timer);
            end();
        },
    };
}

export const where = {
    id: 'where',
    title: N_('Who was where'),
    least: 'administrator',
    make
};
