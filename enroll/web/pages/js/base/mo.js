/* Reads a binary catalogue of gettext (.mo) of either byte order. Pure. */

const MAGIC = 0x950412de;

function texts(bytes, view, table, count, little) {
    const decoder = new TextDecoder('utf-8', { fatal: true });
    const out = [];
    for (let i = 0; i < count; i += 1) {
        const length = view.getUint32(table + 8 * i, little);
        const at = view.getUint32(table + 8 * i + 4, little);
        if (at + length > bytes.length) {
            throw new RangeError('the catalogue is cut');
        }
        out.push(decoder.decode(bytes.subarray(at, at + length)));
    }
    return out;
}

/* The texts of a catalogue, as a Map from the English text. The entry of the empty text is the
 * head. Throws a RangeError or TypeError if the bytes are no catalogue. */
export function parseCatalogue(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const little = view.getUint32(0, true) === MAGIC;
    if (!little && view.getUint32(0, false) !== MAGIC) {
        throw new RangeError('this is no catalogue');
    }
    if (view.getUint32(4, little) >>> 16 > 1) {
        throw new RangeError('the catalogue has an unknown version');
    }
    const count = view.getUint32(8, little);
    const from = texts(bytes, view, view.getUint32(12, little), count, little);
    const to = texts(bytes, view, view.getUint32(16, little), count, little);
    return new Map(from.map((text, i) => [text, to[i]]));
}
