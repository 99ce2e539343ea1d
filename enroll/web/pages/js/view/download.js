/* Gives the user a file that was made in the page. */

import {h} from '../base/dom.js';

export function download(name, text, type = 'text/csv;charset=utf-8') {
    const url = URL.createObjectURL(new Blob([text], { type }));
    const link = h('a', { href: url, download: name, hidden: true });
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(url), 60000);
}

/* A name with today's date: "isotherm-people-2026-03-01.csv". */
export function datedName(stem) { return `isotherm-${stem}-${new Date().toISOString().slice(0, 10)}.csv`; }
