/* The page Events: the records of the log, the newest first. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h, say} from '../base/dom.js';
import {fromLocalInput, number} from '../base/format.js';
import {writeCsv} from '../base/csv.js';
import {fold, matcher} from '../base/fold.js';
import {firstFrom} from '../base/log_search.js';
import {word} from '../base/words.js';
import {EVENTS} from '../base/words_log.js';
import {faultText} from '../transport/fault.js';
import {datedName, download} from '../view/download.js';
import {choice, field, input} from '../view/fields.js';
import {stack} from '../view/stack.js';
import {recordCells, recordRow, recordHeads} from './record_row.js';
import {verifyButton} from './verify_log.js';

const PAGE = 200;         /* records of one request */
const WANTED = 50;        /* rows that "load older" tries to add */
const REQUESTS_MOST = 25; /* without a row that fits, before the user is asked again */

function plain(record) { return typeof record === 'string' ? JSON.parse(record) : record; }

function filters(changed) {
    const kind = choice([['', _('All events')], ...Object.keys(EVENTS).map((key) => [key, word(EVENTS, key)])], '');
    const person = input({ type: 'search', spellcheck: 'false' });
    const from = input({ type: 'datetime-local' });
    const until = input({ type: 'datetime-local' });
    let timer = 0;
    for (const element of [kind, person, from, until]) {
        element.addEventListener(element === person ? 'input' : 'change', () => {
            clearTimeout(timer);
            timer = setTimeout(changed, element === person ? 250 : 0);
        });
    }
    return {
        element:
            h('div', { class: 'bar fields' }, field(_('Event'), kind), field(_('Person'), person),
              field(_('From'), from), field(_('Until'), until)),
        fits() {
            const takes = matcher(person.value);
            return (record) => (!kind.value || record.event === kind.value) &&
                (!person.value.trim() || takes(fold(record.person ?? '')));
        },
        fromMs: () => fromLocalInput(from.value) * 1000 || 0,
        untilMs: () => fromLocalInput(until.value) * 1000 || 0,
        stop: () => clearTimeout(timer),
    };
}

function make({ api, hub }) {
    const body = h('tbody', {});
    const status = h('p', { class: 'quiet', role: 'status' });
    const fault = h('p', { class: 'fault', role: 'alert' });
    const older = h('button', { type: 'button', class: 'plain', onclick: () => load() }, _('Load older'));
    const range = filters(() => restart());
    /* Records from `first` to `end` - 1 have been read; nothing below `least` is wanted. */
    const state = { rows: [], first: 0, end: 0, least: 1, open: true, turn: 0 };

    async function read(query, turn) {
        const answer = await api.log(query);
        if (turn !== state.turn) {
            throw new DOMException('another filter was chosen', 'AbortError');
        }
        return { last: answer.last ?? 0, records: (answer.records ?? []).map(plain) };
    }

    function note() {
        older.hidden = state.first <= state.least;
        say(status,
            _f('Shown: {n}', { n: number(state.rows.length) }) +
                (older.hidden ? ` · ${_('This is the beginning.')}` : ''));
    }

    async function load() {
        const { turn } = state;
        const fits = range.fits();
        older.disabled = true;
        fill(fault);
        try {
            for (let added = 0, requests = 0; state.first > state.least && added < WANTED && requests < REQUESTS_MOST;
                 requests += 1) {
                say(status, _f('Reading from record {n}…', { n: number(state.first) }));
                const { records } = await read({ before: state.first, max: PAGE }, turn);
                const fresh = records.filter((record) => record.sequence >= state.least);
                const shown = fresh.filter(fits).toReversed();
                state.rows.push(...shown);
                body.append(...shown.map(recordRow));
                added += shown.length;
                state.first = fresh.length === records.length && records.length ? records[0].sequence : state.least;
            }
            note();
        } catch (error) {
            if (error.name !== 'AbortError') {
                fill(fault, faultText(error));
            }
        } finally {
            older.disabled = false;
        }
    }

    async function restart() {
        state.turn += 1;
        const { turn } = state;
        Object.assign(state, { rows: [], first: 0, end: 0, least: 1 });
        fill(body);
        fill(fault);
        say(status, _('Loading…'));
        try {
            const { last } = await read({ max: 1 }, turn);
            const one = async (from) => (await read({ from, max: 1 }, turn)).records[0];
            state.least = range.fromMs() ? await firstFrom(one, last, range.fromMs()) : 1;
            state.open = !range.untilMs() || range.untilMs() > Date.now();
            state.end = state.open ? last + 1 : await firstFrom(one, last, range.untilMs());
            state.first = state.end;
            await load();
        } catch (error) {
            if (error.name !== 'AbortError') {
                fill(fault, faultText(error));
                say(status, '');
            }
        }
    }

    /* What was recorded since the last request. */
    async function newer() {
        const { turn } = state;
        if (!state.open || !state.end) {
            return;
        }
        try {
            const { records } = await read({ from: state.end, max: PAGE }, turn);
            const fits = range.fits();
            const fresh = records.filter((record) => record.sequence >= state.end);
            if (fresh.length) {
                state.end = fresh.at(-1).sequence + 1;
                const shown = fresh.filter(fits).toReversed();
                state.rows.unshift(...shown);
                body.prepend(...shown.map(recordRow));
                note();
            }
        } catch {
            /* the banner says that the connection is lost; the next event asks again */
        }
    }

    let timer = 0;
    const soon = () => {
        clearTimeout(timer);
        timer = setTimeout(newer, 300);
    };
    const ends = ['visit', 'door', 'enrolment', 'connection', 'status'].map((name) => hub.on(name, soon));
    restart();
    return {
        element:
            h(
                'div', {}, range.element,
                h('div', { class: 'bar' },
                  h(
                      'button', {
                          type: 'button',
                          class: 'plain',
                          onclick:
                              () =>
                                  download(
                                      datedName('events'), writeCsv([
                                          [_('Number'), _('Time'), _('Event'), _('Person'), _('Verdict'), _('Details')],
                                          ...state.rows.map((record) => recordCells(record, true))
                                      ]))
                      },
                      _('Download CSV')),
                  verifyButton(api)),
                fault,
                h('div', { class: 'panel scroll', tabindex: 0, role: 'region', 'aria-label': _('Events') },
                  stack(h(
                      'table', { class: 'log' }, h('caption', { class: 'unseen' }, _('Events')), recordHeads(), body))),
                status, h('div', { class: 'buttons start' }, older)),
        resume: newer,
        leave() {
            state.turn += 1;
            clearTimeout(timer);
            range.stop();
            ends.forEach((end) => end());
        },
    };
}

export const events = {
    id: 'events',
    title: N_('Events'),
    least: 'administrator',
    make
};
