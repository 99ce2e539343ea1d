/* Finds the records of a time in the log, by binary search over their numbers. */

/* The number of the first record that is not before `timeMs`, or last + 1. read(from) resolves to
 * the first kept record from that number on, or undefined. Earlier records may be gone: then the
 * first kept one stands for them. */
export async function firstFrom(read, last, timeMs) {
    let low = 1;
    let high = last + 1;
    while (low < high) {
        const middle = Math.floor((low + high) / 2);
        const record = await read(middle);
        if (!record || record.sequence > last) {
            high = middle;
        } else if (new Date(record.time).getTime() >= timeMs) {
            high = middle;
        } else {
            low = Math.max(middle, record.sequence) + 1;
        }
    }
    return low;
}
