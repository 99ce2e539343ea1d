/* Catalogues, the choice of a language, and the search by name. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load } from './sources.mjs';

const { parseCatalogue } = await load('base/mo.js');
const { chooseLanguage, place } = await load('base/i18n.js');
const { fold, matcher, nameKey } = await load('base/fold.js');

/* A catalogue in the given byte order, as the manual of gettext describes the format. */
function catalogue(pairs, little) {
    const texts = [...pairs.map(([from]) => from), ...pairs.map(([, to]) => to)].map((text) => Buffer.from(text));
    const n = pairs.length;
    const head = Buffer.alloc(28 + 16 * n);
    const put = (value, at) => (little ? head.writeUInt32LE(value, at) : head.writeUInt32BE(value, at));
    [0x950412de, 0, n, 28, 28 + 8 * n, 0, 0].forEach((value, i) => put(value, 4 * i));
    let at = head.length;
    texts.forEach((text, i) => {
        put(text.length, 28 + 8 * i);
        put(at, 32 + 8 * i);
        at += text.length + 1;
    });
    return new Uint8Array(Buffer.concat([head, ...texts.flatMap((text) => [text, Buffer.alloc(1)])]));
}

const pairs = [['', 'Language: de\n'], ['Door', 'Tür'], ['{n} people', '{n} 人']];

for (const little of [true, false]) {
    test(`a catalogue is read, ${little ? 'little' : 'big'} endian`, () => {
        assert.deepEqual([...parseCatalogue(catalogue(pairs, little))], pairs);
    });
}

test('bytes that are no catalogue are refused', () => {
    const good = catalogue(pairs, true);
    for (const bytes of [new Uint8Array(0), new Uint8Array(40), good.subarray(0, 60), good.subarray(0, 80)]) {
        assert.throws(() => parseCatalogue(bytes));
    }
    const later = catalogue(pairs, true);
    later[6] = 2;
    assert.throws(() => parseCatalogue(later), RangeError);
});

test('the first language that has a catalogue is chosen', () => {
    assert.equal(chooseLanguage(['pt-BR', 'fr-CA', 'de']), 'fr');
    assert.equal(chooseLanguage(['zh-Hans-SG']), 'zh_CN');
    assert.equal(chooseLanguage(['zh-TW', 'de-AT']), 'de');
    assert.equal(chooseLanguage(['zh_CN']), 'zh_CN');
    assert.equal(chooseLanguage(['EN-GB', 'de']), 'en');
    assert.equal(chooseLanguage(['constructor', 'xx']), 'en');
});

test('values get into their places', () => {
    assert.equal(place('{b} and {a}, {c}', { a: 1, b: '{a}' }), '{a} and 1, {c}');
});

test('the search finds names without regard to case and accents', () => {
    const finds = (query, name) => matcher(query)(fold(name));
    assert.ok(finds('jose', 'José García') && finds('GARCIA jos', 'José García'));
    assert.ok(finds('strasse', 'Anna Straße') && finds('sorensen', 'Sørensen') && finds('łuk', 'Lukasz'));
    assert.ok(finds('محمد', 'مُحَمَّد') && finds('ｌｉ', 'Li 雷') && finds('雷', 'Li 雷'));
    assert.ok(finds('', 'Ada') && finds('  ', 'Ada'));
    assert.ok(!finds('adam', 'Ada') && !finds('ada bob', 'Ada'));
});

test('spellings of one name have one key, accents make another', () => {
    assert.equal(nameKey('STRASSE'), nameKey('straße'));
    assert.equal(nameKey('Jose\u0301'), nameKey('JOSÉ'));
    assert.notEqual(nameKey('Jose'), nameKey('José'));
});
