/* The streams: records, their borders, events, the back-off, and the shading of a relief. */

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { load, read } from './sources.mjs';

const { decodeOutline, decodeRelief, isSet } = await load('stream/record.js');
const { Splitter } = await load('stream/splitter.js');
const { EventParser } = await load('stream/event_parser.js');
const { backOffMs } = await load('stream/steady.js');
const { shade } = await load('stream/shade.js');

function head(kind, size) {
    const bytes = Buffer.alloc(size);
    bytes[0] = 1;
    bytes[1] = kind;
    bytes.writeUInt16LE(513, 2);
    bytes.writeUInt32LE(0x01020304, 4);
    bytes.writeBigInt64LE(0x0102030405060708n, 8);
    return bytes;
}

function outline() {
    const bytes = head(1, 932);
    bytes.writeUInt16LE(612, 16);
    bytes[18] = 2;
    bytes[19] = 3;
    bytes.write('watch', 20);
    bytes.write('too-far', 32);
    bytes.write('deny', 52);
    bytes.write('locked-out', 60);
    bytes[76 + 10 * 7 + 2] = 0x20; /* column 18 of row 7 */
    [[32, 64], [-16, 96], [2560, 1920]].forEach(([x, y], i) => {
        bytes.writeInt16LE(x, 676 + 4 * i);
        bytes.writeInt16LE(y, 678 + 4 * i);
    });
    return new Uint8Array(bytes);
}

test('the sizes are those of the header', () => {
    const header = read('firmware/contract/stream_record.h');
    for (const line of ['ISO_STREAM_VERSION = 1', 'ISO_STREAM_HEAD_BYTES = 16', 'ISO_SILHOUETTE_COLUMNS = 80',
        'ISO_SILHOUETTE_ROWS = 60', 'ISO_OUTLINE_POINTS = 64', 'ISO_OUTLINE_UNITS = 32',
        'ISO_RELIEF_COLUMNS = 160', 'ISO_RELIEF_ROWS = 120']) {
        assert.ok(header.includes(line), line);
    }
});

test('an outline is decoded', () => {
    const record = decodeOutline(outline());
    assert.equal(record.missed, 513);
    assert.equal(record.sequence, 0x01020304);
    assert.equal(record.timeNs, 0x0102030405060708n);
    assert.equal(record.distanceMm, 612);
    assert.deepEqual([record.lockdown, record.lockedOut], [false, true]);
    assert.deepEqual([record.mode, record.hint, record.verdict, record.reason],
        ['watch', 'too-far', 'deny', 'locked-out']);
    assert.deepEqual(record.outline, [[1, 2], [-0.5, 3], [80, 60]]);
    const set = [];
    for (let row = -1; row <= 60; row += 1) {
        for (let column = -1; column <= 80; column += 1) {
            if (isSet(record.silhouette, column, row)) {
                set.push([column, row]);
            }
        }
    }
    assert.deepEqual(set, [[18, 7]]);
});

test('a record that is not as described is refused', () => {
    const damage = (at, value) => {
        const bytes = outline();
        bytes[at] = value;
        return bytes;
    };
    const wrong = [damage(0, 2), damage(1, 2), damage(19, 2), damage(19, 65), damage(20, 65), damage(31, 97),
        damage(40, 97), outline().subarray(0, 931), new Uint8Array(0), new Uint8Array(933)];
    for (const [i, bytes] of wrong.entries()) {
        assert.equal(decodeOutline(bytes), null, `record ${i}`);
    }
});

function relief(rows, columns, depth, packed) {
    const bytes = head(2, 20);
    bytes.writeUInt16LE(columns, 16);
    bytes.writeUInt16LE(rows, 18);
    const differences = Buffer.alloc(2 * depth.length);
    depth.forEach((mm, i) => {
        const left = i % columns ? depth[i - 1] : 0;
        differences.writeUInt16LE((mm - left + 65536) % 65536, 2 * i);
    });
    return new Uint8Array(Buffer.concat([bytes, packed ?? deflateSync(differences)]));
}

test('a relief is unpacked', async () => {
    const depth = [0, 700, 690, 65535, 3, 0];
    const record = await decodeRelief(relief(2, 3, depth));
    assert.deepEqual([record.columns, record.rows, [...record.depth]], [3, 2, depth]);
});

test('a relief of another size than its head says, or no zlib data, is refused', async () => {
    const depth = [1, 2, 3, 4, 5, 6];
    assert.equal(await decodeRelief(relief(2, 3, depth, deflateSync(Buffer.alloc(14)))), null);
    assert.equal(await decodeRelief(relief(2, 3, depth, deflateSync(Buffer.alloc(10)))), null);
    assert.equal(await decodeRelief(relief(2, 3, depth, Buffer.from('no zlib data'))), null);
    assert.equal(await decodeRelief(relief(121, 160, [1])), null);
    assert.equal(await decodeRelief(relief(1, 0, [])), null);
});

test('records are found wherever the stream is cut', () => {
    const stream = Buffer.from([2, 0, 0, 0, 7, 8, 0, 0, 0, 0, 3, 0, 0, 0, 1, 2, 3]);
    for (let size = 1; size <= stream.length; size += 1) {
        const splitter = new Splitter();
        const found = [];
        for (let at = 0; at < stream.length; at += size) {
            found.push(...splitter.push(stream.subarray(at, at + size)));
        }
        assert.deepEqual(found.map((record) => [...record]), [[7, 8], [], [1, 2, 3]], `pieces of ${size}`);
    }
    assert.throws(() => new Splitter().push(new Uint8Array([0, 0, 0, 1])), RangeError);
});

test('events are found wherever the text is cut', () => {
    const text = ': note\n\nevent: visit\ndata: {"a":\ndata: 1}\n\nevent: empty\n\ndata:x\r\n\r\n';
    for (let size = 1; size <= text.length; size += 1) {
        const parser = new EventParser();
        const found = [];
        for (let at = 0; at < text.length; at += size) {
            found.push(...parser.push(text.slice(at, at + size)));
        }
        assert.deepEqual(found, [{ name: 'visit', data: '{"a":\n1}' }, { name: 'message', data: 'x' }],
            `pieces of ${size}`);
    }
});

test('the wait grows and has an end', () => {
    assert.equal(backOffMs(0, 0.5), 500);
    assert.equal(backOffMs(2, 0.5), 2000);
    assert.equal(backOffMs(900, 0.5), 15000);
    assert.ok(backOffMs(3, 0) < backOffMs(3, 1));
});

test('light falls from the upper left', () => {
    const columns = 9;
    const plane = (dx, dy) => shade(Uint16Array.from({ length: 81 },
        (_, i) => 600 + dx * (i % columns) + dy * Math.floor(i / columns)), columns, columns)[40];
    const flat = plane(0, 0);
    assert.ok(plane(-4, 0) > flat, 'a slope that looks to the left is bright');
    assert.ok(plane(4, 0) < flat, 'a slope that looks to the right is dark');
    assert.ok(plane(0, -4) > flat && plane(0, 4) < flat, 'the same up and down');
});

test('what was not measured, or is far behind, is black', () => {
    const out = shade(Uint16Array.of(600, 600, 0, 600, 600, 1200, 600, 600, 600), 3, 3);
    assert.deepEqual([out[2], out[5]], [0, 0]);
    assert.ok(out[0] > 0);
});
