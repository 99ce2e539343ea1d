/* A request that failed. `code` is a word of the API that keeps its meaning; `detail` is a sentence
 * of the server, in English. */

import {_, _f} from '../base/i18n.js';
import {duration} from '../base/format.js';
import {FAULTS} from '../base/words_faults.js';

export class Fault extends Error {
    constructor(code, { status = 0, detail = '', setup = false, retryAfterS = 0 } = {}) {
        super(detail || code);
        Object.assign(this, { code, status, detail, setup, retryAfterS });
    }
}

const tables = [FAULTS];

/* Adds a table of codes that comes before those that are known. */
export function addFaultWords(table) { tables.unshift(table); }

/* Codes whose sentence of the server says more than the table does. */
const SPECIFIC = /^invalid-(account|credential|limits|name|password|policy|setting|value)$|^(card-in-use|internal|storage)$/;

/* The sentence for people. */
export function faultText(fault) {
    const table = tables.find((one) => Object.hasOwn(one, fault.code ?? ''));
    const known = table ? _(table[fault.code]) : '';
    if (fault.code === 'too-many-attempts' && fault.retryAfterS > 0) {
        return _f('Too many attempts. Please try again in {time}.', { time: duration(fault.retryAfterS * 1000) });
    }
    if (!known) {
        return fault.detail || String(fault.message ?? fault);
    }
    return SPECIFIC.test(fault.code) && fault.detail ? `${known} (${fault.detail})` : known;
}
