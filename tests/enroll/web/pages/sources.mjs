/* Where the tests find the pages, and the words that the headers and sources in C declare. */

import { readFileSync } from 'node:fs';

export const ROOT = new URL('../../../../', import.meta.url);
const PAGES = new URL('enroll/web/pages/js/', ROOT);

export const load = (path) => import(new URL(path, PAGES));
export const read = (path) => readFileSync(new URL(path, ROOT), 'utf8');

/* Every text in quotation marks of the piece of a source between two texts. */
export function quoted(path, from, to) {
    const source = read(path);
    const begin = source.indexOf(from);
    const end = source.indexOf(to, begin + from.length);
    if (begin < 0 || end < 0) {
        throw new Error(`${path} has no piece from ${from} to ${to}`);
    }
    return [...source.slice(begin, end).matchAll(/"([a-z-]+)"/g)].map((match) => match[1]);
}
