/* The list of people as CSV, and what a CSV file would change. The file has all that is known of a
 * person except the templates: those never leave the appliance this way. Pure. */

import {readCsv, writeCsv} from './csv.js';
import {nameKey} from './fold.js';

export const COLUMNS = ['name', 'valid_from', 'valid_until', 'enrolled', 'templates', 'last_seen'];

/* The column of cards, which only administrators know: separated by blanks. */
const CARDS = 'cards';
const CARD = /^\d{1,5}\/\d{1,5}$|^\d{1,2}:[0-9a-f]{1,16}$/i;
const CARDS_MOST = 4;

const LAST_S = 253402300799; /* the end of the year 9999 */

function time(seconds) { return seconds ? new Date(seconds * 1000).toISOString().replace('.000Z', 'Z') : ''; }

/* The people as CSV; times are RFC 3339 in UTC, an empty one means no limit, or never. */
export function peopleToCsv(people) {
    const withCards = people.some((person) => person.cards);
    const cards = (person) => (withCards ? [(person.cards ?? []).join(' ')] : []);
    return writeCsv([
        withCards ? [...COLUMNS, CARDS] : COLUMNS,
        ...people.map(
            (person) =>
                [person.name, time(person.valid_from_s), time(person.valid_until_s), time(person.enrolled_s),
                 person.templates, time(person.last_seen_s), ...cards(person)])
    ]);
}

/* Seconds since 1970 of a time in a file; 0 for an empty one; NaN for what is no time. A time
 * without a zone is local time, a date alone is its first moment: people write these by hand. */
export function readTime(text) {
    const trimmed = text.trim();
    if (trimmed === '') {
        return 0;
    }
    const parts =
        /^(\d{4})-(\d\d)-(\d\d)(?:[T ](\d\d):(\d\d)(?::(\d\d)(?:\.\d+)?)?)?\s*(Z|[+-]\d\d:?\d\d)?$/i.exec(trimmed);
    if (!parts) {
        return NaN;
    }
    const [year, month, day, hour, minute, second] = parts.slice(1, 7).map((part) => Number(part ?? 0));
    const days = new Date(Date.UTC(year, month, 0)).getUTCDate();
    if (month < 1 || month > 12 || day < 1 || day > days || hour > 23 || minute > 59 || second > 59) {
        return NaN;
    }
    const zone = (parts[7] ?? '').toUpperCase();
    let ms = Date.UTC(year, month - 1, day, hour, minute, second);
    if (zone === '') {
        ms = new Date(year, month - 1, day, hour, minute, second).getTime();
    } else if (zone !== 'Z') {
        const sign = zone[0] === '-' ? 1 : -1;
        ms += sign * (Number(zone.slice(1, 3)) * 60 + Number(zone.slice(-2))) * 60000;
    }
    const seconds = Math.floor(ms / 1000);
    return seconds > 0 && seconds <= LAST_S ? seconds : NaN;
}

/* The cards of a cell; null for what are none. */
function readCards(text) {
    const cards = [...new Set(text.split(/\s+/).filter(Boolean))];
    return cards.length <= CARDS_MOST && cards.every((card) => CARD.test(card)) ? cards : null;
}

/* What one row would change: {name, kind, why, change}. kind: "change", "unchanged", "missing" (the
 * person is not enrolled here), "invalid" (why: a word of the table in words.js). A column that the
 * file does not have leaves that limit as it is. */
function planRow(row, at, known, seen) {
    const cell = (column) => (at[column] < 0 ? null : row[at[column]] ?? '');
    const name = cell('name').trim();
    const invalid = (why) => ({ name, kind: 'invalid', why });
    if (name === '') {
        return invalid('name-missing');
    }
    const person = known.get(nameKey(name));
    if (!person) {
        return { name, kind: 'missing' };
    }
    if (seen.has(person)) {
        return invalid('name-twice');
    }
    seen.add(person);
    const change = { valid_from_s: person.valid_from_s, valid_until_s: person.valid_until_s };
    for (const [column, key] of [['valid_from', 'valid_from_s'], ['valid_until', 'valid_until_s']]) {
        const text = cell(column);
        if (text !== null) {
            change[key] = readTime(text);
        }
        if (Number.isNaN(change[key])) {
            return invalid(`${column.replace('_', '-')}-wrong`);
        }
    }
    if (change.valid_from_s && change.valid_until_s && change.valid_from_s >= change.valid_until_s) {
        return invalid('limits-reversed');
    }
    const text = person.cards ? cell(CARDS) : null;
    const cards = text === null ? null : readCards(text);
    if (text !== null && !cards) {
        return invalid('cards-wrong');
    }
    if (cards && cards.toSorted().join() !== person.cards.toSorted().join()) {
        change.cards = cards;
    }
    const same =
        change.valid_from_s === person.valid_from_s && change.valid_until_s === person.valid_until_s && !change.cards;
    return same ? { name: person.name, kind: 'unchanged', person } :
                  { name: person.name, kind: 'change', person, change };
}

/* What a file would change, row by row. Throws a SyntaxError with a word of the table in words.js
 * if it is no list of people. */
export function planImport(text, people) {
    let rows;
    try {
        rows = readCsv(text);
    } catch {
        throw new SyntaxError('not-csv');
    }
    const heads = (rows[0] ?? []).map((head) => head.trim().toLowerCase());
    const at = Object.fromEntries([...COLUMNS, CARDS].map((column) => [column, heads.indexOf(column)]));
    if (at.name < 0) {
        throw new SyntaxError('no-name-column');
    }
    if (at.valid_from < 0 && at.valid_until < 0 && at.cards < 0) {
        throw new SyntaxError('no-limit-columns');
    }
    const known = new Map(people.map((person) => [nameKey(person.name), person]));
    const seen = new Set();
    return rows.slice(1).map((row, i) => ({ line: i + 2, ...planRow(row, at, known, seen) }));
}
