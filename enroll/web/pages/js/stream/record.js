/* Decodes the records of the streams, as firmware/contract/stream_record.h describes them. A record
 * that is not as described is refused as a whole. Pure. */

export const COLUMNS = 80;
export const ROWS = 60;
const HEAD_BYTES = 16;
const POINTS = 64;
const UNITS = 32; /* of a coordinate in one silhouette point */
const OUTLINE_BYTES = 676 + 4 * POINTS;
const RELIEF_COLUMNS = 160;
const RELIEF_ROWS = 120;
const KIND = {
    outline: 1,
    relief: 2
};

function head(view, kind) {
    if (view.byteLength < HEAD_BYTES + 4 || view.getUint8(0) !== 1 || view.getUint8(1) !== kind) {
        return null;
    }
    return {
        missed: view.getUint16(2, true),
        sequence: view.getUint32(4, true),
        timeNs: view.getBigInt64(8, true),
    };
}

function word(bytes, at, size) {
    const text = String.fromCharCode(...bytes.subarray(at, at + size));
    const match = /^([a-z-]*)\0+$/.exec(text);
    return match ? match[1] : null;
}

const view = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

/* An outline, or null: {sequence, missed, timeNs, distanceMm, lockdown, lockedOut, mode, hint,
 * verdict, reason, silhouette: Uint8Array, outline: [[x, y], ...] in silhouette points}. */
export function decodeOutline(bytes) {
    const data = view(bytes);
    const begin = head(data, KIND.outline);
    const n = begin ? bytes[19] : 0;
    if (!begin || bytes.length !== OUTLINE_BYTES || n > POINTS || n === 1 || n === 2) {
        return null;
    }
    const words = [[20, 12], [32, 20], [52, 8], [60, 16]].map(([at, size]) => word(bytes, at, size));
    if (words.includes(null)) {
        return null;
    }
    const outline = Array.from(
        { length: n }, (_, i) => [data.getInt16(676 + 4 * i, true) / UNITS, data.getInt16(678 + 4 * i, true) / UNITS]);
    const [mode, hint, verdict, reason] = words;
    return {
        ...begin,
        mode,
        hint,
        verdict,
        reason,
        outline,
        distanceMm: data.getUint16(16, true),
        lockdown: (bytes[18] & 1) !== 0,
        lockedOut: (bytes[18] & 2) !== 0,
        silhouette: bytes.slice(76, 676),
    };
}

/* Whether a point of a silhouette is set; a point outside is not. */
export function isSet(silhouette, column, row) {
    if (column < 0 || row < 0 || column >= COLUMNS || row >= ROWS) {
        return false;
    }
    return (silhouette[row * (COLUMNS / 8) + (column >> 3)] >> (7 - (column & 7)) & 1) === 1;
}

async function inflate(bytes, most) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    const out = new Uint8Array(most);
    let size = 0;
    for (const reader = stream.getReader();;) {
        const { done, value } = await reader.read();
        if (done) {
            return out.subarray(0, size);
        }
        if (size + value.length > most) {
            await reader.cancel();
            return null; /* more than the head says */
        }
        out.set(value, size);
        size += value.length;
    }
}

/* Depths from differences: each is that to its left neighbour, the first of a row that to 0. */
export function undoDifferences(bytes, columns, rows) {
    const data = view(bytes);
    const depth = new Uint16Array(columns * rows);
    for (let row = 0; row < rows; row += 1) {
        let last = 0;
        for (let i = row * columns; i < (row + 1) * columns; i += 1) {
            last = (last + data.getUint16(2 * i, true)) & 0xffff;
            depth[i] = last;
        }
    }
    return depth;
}

/* A relief as the server packs it, or null: {sequence, missed, timeNs, columns, rows, depth:
 * Uint16Array of millimetres, 0: not measured}. */
export async function decodeRelief(bytes) {
    const data = view(bytes);
    const begin = head(data, KIND.relief);
    const columns = begin ? data.getUint16(16, true) : 0;
    const rows = begin ? data.getUint16(18, true) : 0;
    if (columns < 1 || columns > RELIEF_COLUMNS || rows < 1 || rows > RELIEF_ROWS) {
        return null;
    }
    try {
        const plain = await inflate(bytes.subarray(20), 2 * columns * rows);
        if (!plain || plain.length !== 2 * columns * rows) {
            return null;
        }
        return {...begin, columns, rows, depth: undoDifferences(plain, columns, rows) };
    } catch {
        return null; /* no zlib data */
    }
}
