/* CSV as RFC 4180 describes it, for spreadsheets. Pure. */

/* A text that a spreadsheet would take for a formula gets an apostrophe before it. Reading takes
 * the apostrophe away, and a text that begins with apostrophes before such a character gets one
 * more, so that every text comes back as it was. */
const FORMULA = /^'*[=+\-@\t\r]/;

function guard(text) { return FORMULA.test(text) ? `'${text}` : text; }

function unguard(text) { return text.startsWith("'") && FORMULA.test(text) ? text.slice(1) : text; }

function field(value) {
    const text = guard(value === null || value === undefined ? '' : String(value));
    return /[",\r\n]/.test(text) || text !== text.trim() ? `"${text.replaceAll('"', '""')}"` : text;
}

/* Rows of values as CSV: UTF-8 with a byte order mark (spreadsheets need it), CR LF at each end. */
export function writeCsv(rows) { return `\ufeff${rows.map((row) => `${row.map(field).join(',')}\r\n`).join('')}`; }

function separator(text) {
    const first = text.slice(0, text.search(/[\r\n]|$/));
    const count = (mark) => first.split(mark).length - 1;
    return [',', ';', '\t'].reduce((best, mark) => (count(mark) > count(best) ? mark : best), ',');
}

/* Reads the field that begins at `at`: [text, where it ends]. */
function readField(text, at, mark) {
    if (text[at] !== '"') {
        let end = at;
        while (end < text.length && text[end] !== mark && text[end] !== '\n' && text[end] !== '\r') {
            end += 1;
        }
        return [text.slice(at, end), end];
    }
    let value = '';
    let from = at + 1;
    for (;;) {
        const quote = text.indexOf('"', from);
        if (quote < 0) {
            throw new SyntaxError('a quotation mark is missing');
        }
        value += text.slice(from, quote);
        if (text[quote + 1] !== '"') {
            return [value, quote + 1];
        }
        value += '"';
        from = quote + 2;
    }
}

/* The rows of a CSV text. Spreadsheets of some countries separate by semicolons, which is
 * accepted. Empty lines are left out. Throws a SyntaxError for a quotation mark without its end, or
 * text after it. */
export function readCsv(input) {
    const text = input.startsWith('\ufeff') ? input.slice(1) : input;
    const mark = separator(text);
    const rows = [];
    let row = [];
    let at = 0;
    while (at < text.length) {
        const [value, end] = readField(text, at, mark);
        row.push(unguard(value));
        at = end;
        if (text[at] === mark) {
            at += 1;
            if (at < text.length) {
                continue;
            }
            row.push('');
        } else if (at < text.length && text[at] !== '\r' && text[at] !== '\n') {
            throw new SyntaxError('there is text after a quotation mark');
        }
        at += text.startsWith('\r\n', at) ? 2 : 1;
        if (row.length > 1 || row[0] !== '') {
            rows.push(row);
        }
        row = [];
    }
    return rows;
}
