/* Cuts a stream of bytes into records: before each record stands its length (uint32, little
 * endian). Pure. */

const MOST_BYTES = 1 << 16;

export class Splitter {
    #rest = new Uint8Array(0);

    /* Takes bytes; returns the records that are complete now. Throws a RangeError for a length that
     * no record has: the stream cannot be read any further. */
    push(bytes) {
        const all = new Uint8Array(this.#rest.length + bytes.length);
        all.set(this.#rest);
        all.set(bytes, this.#rest.length);
        const data = new DataView(all.buffer);
        const records = [];
        let at = 0;
        while (at + 4 <= all.length) {
            const length = data.getUint32(at, true);
            if (length > MOST_BYTES) {
                throw new RangeError(`a record of ${length} bytes`);
            }
            if (at + 4 + length > all.length) {
                break;
            }
            records.push(all.slice(at + 4, at + 4 + length));
            at += 4 + length;
        }
        this.#rest = all.slice(at);
        return records;
    }
}
