/* What decides the view and needs no browser: how long a hint stays, pieces of a chart, the search by
 * time, and the contrast of the colours. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { load, read } from './sources.mjs';

const { holdHint, SHOWN_MS } = await load('view/hint_hold.js');
const { pieces, roundUp } = await load('view/chart.js');
const { firstFrom } = await load('base/log_search.js');

test('a hint stays long enough to be read, and the newest one follows', () => {
    let now = 0;
    let due = null;
    const shown = [];
    const say = holdHint((text) => shown.push([now, text]), {
        now: () => now, later: (run, ms) => { due = { run, at: now + ms }; } });
    const at = (time, text, atOnce = false) => {
        if (due && due.at <= time) {
            const { run } = due;
            now = due.at;
            due = null;
            run();
        }
        now = time;
        say(text, atOnce);
    };
    at(0, 'a');
    at(100, 'b');
    at(200, 'c');
    at(300, 'b');
    at(2000, 'b');
    at(5000, 'd');
    at(5001, 'd');
    at(5100, 'e', true);
    at(9000, 'e');
    assert.equal(SHOWN_MS >= 1200, true);
    assert.deepEqual(shown, [[0, 'a'], [SHOWN_MS, 'b'], [5000, 'd'], [5100, 'e']]);
});

test('a gap breaks the line of a chart, and so does a value that is none', () => {
    const points = [[0, 1], [60, 2], [120, NaN], [180, 3], [600, 4], [660, 5]].map(([time, value]) => ({ time, value }));
    assert.deepEqual(pieces(points).map((piece) => piece.map(({ value }) => value)), [[1, 2], [3], [4, 5]]);
});

test('the scale of a chart ends at a round number', () => {
    assert.deepEqual([0, NaN, 0.3, 1, 1.2, 4, 29.9, 1400].map(roundUp), [1, 1, 0.5, 1, 2, 5, 50, 2000]);
});

/* A log of records with these times; the first ones may be gone. */
async function search(times, firstKept, time) {
    const records = times.map((t, i) => ({ sequence: i + 1, time: new Date(t * 1000).toISOString() }))
        .filter((record) => record.sequence >= firstKept);
    let reads = 0;
    const found = await firstFrom(async (from) => {
        reads += 1;
        return records.find((record) => record.sequence >= from);
    }, times.length, time * 1000);
    assert.ok(reads <= Math.ceil(Math.log2(times.length + 1)) + 1, `${reads} requests`);
    return found;
}

test('the first record of a time is found with few requests', async () => {
    const times = Array.from({ length: 1000 }, (_, i) => 1700000000 + 7 * i);
    assert.equal(await search(times, 1, 1700000000 + 700), 101);
    assert.equal(await search(times, 1, 1700000000 + 701), 102);
    assert.equal(await search(times, 1, 0), 1);
    assert.equal(await search(times, 1, 1800000000), 1001);
    assert.equal(await search([1, 5, 5, 5, 9], 1, 5), 2);
});

test('records that are gone are stood for by the first one that is kept', async () => {
    const times = Array.from({ length: 1000 }, (_, i) => 1700000000 + 7 * i);
    assert.equal(await search(times, 400, 1700000000 + 7 * 600), 601);
    const found = await search(times, 400, 1700000000);
    assert.ok(found <= 400, `${found} begins after the first record that is kept`);
});

/* Relative luminance and contrast by WCAG 2. */
function luminance(hex) {
    const [r, g, b] = [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255)
        .map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(a, b) {
    const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
    return (high + 0.05) / (low + 0.05);
}

test('text has enough contrast with its ground, light and dark', () => {
    const css = read('enroll/web/pages/css/base.css');
    const [light, dark] = [...css.matchAll(/:root \{([^}]*)\}/g)].map((block) =>
        Object.fromEntries([...block[1].matchAll(/--([a-z-]+): (#[0-9a-f]{6});/g)].map((match) => [match[1], match[2]])));
    assert.ok(Object.keys(light).length >= 20 && Object.keys(dark).length >= 15);
    const wanted = [['text', 'ground', 7], ['text', 'panel', 7], ['text', 'accent-soft', 7], ['good', 'good-soft', 7],
        ['bad', 'bad-soft', 7], ['bad', 'panel', 7], ['odd', 'odd-soft', 7], ['accent', 'panel', 7], ['on-accent', 'accent', 7],
        ['accent', 'accent-soft', 4.5], ['quiet', 'ground', 4.5], ['quiet', 'panel', 4.5], ['quiet', 'accent-soft', 4.5],
        ['edge', 'panel', 3], ['focus', 'ground', 3], ['focus', 'panel', 3], ['face', 'shape', 3]];
    for (const colours of [light, { ...light, ...dark }]) {
        for (const [front, ground, least] of wanted) {
            const found = contrast(colours[front], colours[ground]);
            assert.ok(found >= least, `${front} on ${ground}: ${found.toFixed(2)}`);
        }
    }
});
