/* CSV of spreadsheets, and what a file of people would change. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './sources.mjs';

const { readCsv, writeCsv } = await load('base/csv.js');
const { peopleToCsv, planImport, readTime } = await load('base/people_csv.js');

const day = Date.UTC(2026, 2, 1) / 1000; /* 2026-03-01T00:00:00Z */
const people = [
    { name: 'Ada', enrolled_s: 1700000000, valid_from_s: 0, valid_until_s: day, templates: 5, last_seen_s: null },
    { name: 'Straße', enrolled_s: 1700000001, valid_from_s: 0, valid_until_s: 0, templates: 1, last_seen_s: day },
];

test('rows are written as RFC 4180 says', () => {
    assert.equal(writeCsv([['a', 'b"c', 'd,e', 'f\ng'], [1, null, undefined, ' x']]),
        '\ufeffa,"b""c","d,e","f\ng"\r\n1,,," x"\r\n');
});

test('what a spreadsheet would take for a formula is guarded, and comes back as it was', () => {
    const texts = ['=1+1', '+49', '-x', '@sum', '\tx', "'=a", "''@b", "'quoted'", 'O’Neil', "d'Arc"];
    const written = writeCsv([texts]);
    assert.ok(written.startsWith("\ufeff'=1+1,'+49,'-x,'@sum,"));
    assert.deepEqual(readCsv(written), [texts]);
});

test('every text that is written is read back', () => {
    const rows = [['a', '', '"', '""', ',', 'x\r\ny', '李, 雷'], ['', 'b', '', '', '', '', '']];
    assert.deepEqual(readCsv(writeCsv(rows)), rows);
});

test('files of other programs are read', () => {
    assert.deepEqual(readCsv('a;b\n1;"2;3"\n'), [['a', 'b'], ['1', '2;3']]);
    assert.deepEqual(readCsv('a\tb\r1\t2'), [['a', 'b'], ['1', '2']]);
    assert.deepEqual(readCsv('\ufeffa,b\r\n\r\n1,\r\n'), [['a', 'b'], ['1', '']]);
    assert.deepEqual(readCsv('a,b\n1,'), [['a', 'b'], ['1', '']]);
    assert.deepEqual(readCsv(''), []);
});

test('a quotation mark at the wrong place is refused', () => {
    assert.throws(() => readCsv('a,"b\n'), SyntaxError);
    assert.throws(() => readCsv('a,"b"c\n'), SyntaxError);
});

test('times are read as people and programs write them', () => {
    assert.equal(readTime(' '), 0);
    assert.equal(readTime('2026-03-01T00:00:00Z'), day);
    assert.equal(readTime('2026-03-01T02:30:00+02:30'), day);
    assert.equal(readTime('2026-02-28T19:00:00-0500'), day);
    assert.equal(readTime('2026-03-01'), new Date(2026, 2, 1).getTime() / 1000);
    assert.equal(readTime('2026-03-01 08:05'), new Date(2026, 2, 1, 8, 5).getTime() / 1000);
    for (const wrong of ['tomorrow', '2026-02-30', '2026-13-01', '2026-03-01T24:00Z', '01.03.2026', '1969-01-01Z']) {
        assert.ok(Number.isNaN(readTime(wrong)), wrong);
    }
});

test('the export has all that is known except the templates themselves', () => {
    assert.equal(peopleToCsv(people), '\ufeffname,valid_from,valid_until,enrolled,templates,last_seen\r\n' +
        'Ada,,2026-03-01T00:00:00Z,2023-11-14T22:13:20Z,5,\r\n' +
        'Straße,,,2023-11-14T22:13:21Z,1,2026-03-01T00:00:00Z\r\n');
});

test('an export that is imported again changes nothing', () => {
    assert.deepEqual(planImport(peopleToCsv(people), people).map((row) => row.kind), ['unchanged', 'unchanged']);
});

test('each row says what it would change', () => {
    const plan = planImport('name,valid_from,valid_until\nADA,2026-01-01Z,\nbob,,\nSTRASSE,x,\n,,\nada,,\n', people);
    assert.deepEqual(plan.map(({ line, name, kind, why }) => [line, name, kind, why]), [
        [2, 'Ada', 'change', undefined], [3, 'bob', 'missing', undefined],
        [4, 'STRASSE', 'invalid', 'valid-from-wrong'], [5, '', 'invalid', 'name-missing'],
        [6, 'ada', 'invalid', 'name-twice']]);
    assert.deepEqual(plan[0].change, { valid_from_s: Date.UTC(2026, 0, 1) / 1000, valid_until_s: 0 });
});

test('limits in the wrong order are refused, and a missing column changes nothing', () => {
    const reversed = planImport('name;valid_from;valid_until\nAda;2026-04-01Z;2026-03-01Z\n', people);
    assert.equal(reversed[0].why, 'limits-reversed');
    const half = planImport('name,valid_from\nAda,2026-02-01Z\n', people);
    assert.equal(half[0].change.valid_until_s, day);
});

test('a file that is no list of people is refused with a word', () => {
    for (const [text, word] of [['a,"b', 'not-csv'], ['x,valid_from\n', 'no-name-column'],
        ['name,templates\n', 'no-limit-columns'], ['', 'no-name-column']]) {
        assert.throws(() => planImport(text, people), { message: word });
    }
});

test('cards are written for those who know them, and read back', () => {
    const withCards = people.map((person, i) => ({ ...person, enabled: true, cards: i ? [] : ['17/4711', '56:04a2b3c4d5e6f7'] }));
    const text = peopleToCsv(withCards);
    assert.ok(text.startsWith('\ufeffname,valid_from,valid_until,enrolled,templates,last_seen,cards\r\n'));
    assert.ok(text.includes(',17/4711 56:04a2b3c4d5e6f7\r\n'));
    assert.deepEqual(planImport(text, withCards).map((row) => row.kind), ['unchanged', 'unchanged']);
    const [first, second] = planImport('name,cards\nada,56:04a2b3c4d5e6f7 17/4711\nStraße,1/2\n', withCards);
    assert.equal(first.kind, 'unchanged'); /* the order does not matter */
    assert.deepEqual([second.kind, second.change.cards], ['change', ['1/2']]);
    const [none] = planImport('name,cards\nAda,\n', withCards);
    assert.deepEqual([none.kind, none.change.cards], ['change', []]);
    for (const wrong of ['17-4711', '1/2,3', '123456/1', '56:xyz', '1/1 1/2 1/3 1/4 1/5']) {
        assert.equal(planImport(`name;cards\nAda;"${wrong}"\n`, withCards)[0].why, 'cards-wrong', wrong);
    }
    /* A file with cards does nothing for those who do not know them. */
    assert.deepEqual(planImport('name,valid_from,cards\nAda,,1/2\n', people).map((row) => row.kind), ['unchanged']);
});
