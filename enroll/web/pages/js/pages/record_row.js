/* One record of the log as a row of the page and of a CSV file. */

import {_} from '../base/i18n.js';
import {h} from '../base/dom.js';
import {dateTime, number} from '../base/format.js';
import {CUES, DOOR_ACTS, DOOR_CAUSES, DOOR_STATES, REASONS, RESULTS, VERDICTS, word} from '../base/words.js';
import {EVENTS} from '../base/words_log.js';
import {badge} from '../view/badge.js';

/* A reason is a word of one of these tables, by the event. */
function reason(record) {
    const table = {
        visit: REASONS,
        grant: REASONS,
        attack: REASONS,
        enroll: RESULTS,
        verify: RESULTS,
        identify: RESULTS,
        door: DOOR_CAUSES
    }[record.event];
    return table ? word(table, record.reason) : record.reason ?? '';
}

function door(record) { return word(record.event === 'door' ? DOOR_STATES : DOOR_ACTS, record.door); }

function details(record) {
    const note = Object.hasOwn(CUES, record.note ?? '') ? word(CUES, record.note) : record.note;
    const score = Number.isFinite(record.score) ? `${_('Score')} ${number(record.score, 2)}` : '';
    const change = record.before !== undefined || record.after !== undefined ?
        `${record.before ?? ''} → ${record.after ?? ''}` :
        '';
    return [reason(record), door(record), record.door_fault, change, note, score].filter(Boolean).map(String).join(
        ' · ');
}

/* Number, time, event, person, verdict, details; for a file the time is as in the log. */
export function recordCells(record, file) {
    return [
        record.sequence, file ? record.time : dateTime(record.time, true), word(EVENTS, record.event),
        record.person ?? '', word(VERDICTS, record.verdict), details(record)
    ];
}

export function recordHeads() {
    return h('thead', {}, h('tr', {}, [
                 _('Number'), _('Time'), _('Event'), _('Person'), _('Verdict'), _('Details')
             ].map((text) => h('th', { scope: 'col' }, text))));
}

export function recordRow(record) {
    const [sequence, time, event, person, verdict, more] = recordCells(record, false);
    return h(
        'tr', {}, h('td', { class: 'number' }, sequence),
        h('td', { class: 'whole' }, h('time', { datetime: record.time }, time)), h('td', {}, event),
        h('td', {}, person && h('bdi', {}, person)),
        h('td', {}, record.verdict && badge(record.verdict === 'allow' ? 'good' : 'bad', verdict)),
        h('td', { class: 'details' }, more));
}
