/* Times and numbers as the language writes them. */

import {_, languageTag} from './i18n.js';

/* Arabic pages use the digits 0 to 9, which also the door's log and fingerprints have. */
function tag() { return languageTag() === 'ar' ? 'ar-u-nu-latn' : languageTag(); }

const known = new Map();

function formatter(kind, options) {
    const key = `${tag()} ${kind.name} ${JSON.stringify(options)}`;
    if (!known.has(key)) {
        known.set(key, new kind(tag(), options));
    }
    return known.get(key);
}

/* Date and time, to the minute or the second; "" for a time that is none. */
export function dateTime(when, seconds = false) {
    const date = new Date(when);
    if (Number.isNaN(date.getTime())) {
        return '';
    }
    return formatter(Intl.DateTimeFormat, { dateStyle: 'medium', timeStyle: seconds ? 'medium' : 'short' })
        .format(date);
}

/* The time of day. */
export function timeOfDay(when) {
    const date = new Date(when);
    return Number.isNaN(date.getTime()) ? '' : formatter(Intl.DateTimeFormat, { timeStyle: 'medium' }).format(date);
}

/* The time of day to the minute. */
export function shortTime(when) {
    return formatter(Intl.DateTimeFormat, { timeStyle: 'short' }).format(new Date(when));
}

/* Seconds since 1970 of a limit; 0 is no limit. */
export function limit(seconds) { return seconds ? dateTime(seconds * 1000) : _('no limit'); }

export function number(value, digits = 0) {
    return Number.isFinite(value) ?
        formatter(Intl.NumberFormat, { maximumFractionDigits: digits, minimumFractionDigits: digits }).format(value) :
        '–';
}

export function percent(share) {
    return Number.isFinite(share) ? formatter(Intl.NumberFormat, { style: 'percent' }).format(share) : '–';
}

/* A duration in the two largest units that it has. */
export function duration(milliseconds) {
    const s = Math.max(0, Math.round(milliseconds / 1000));
    const parts = [
        [Math.floor(s / 86400), 'day'], [Math.floor(s / 3600) % 24, 'hour'], [Math.floor(s / 60) % 60, 'minute'],
        [s % 60, 'second']
    ];
    const first = parts.findIndex(([n]) => n > 0);
    const shown = first < 0 ? [parts[3]] : parts.slice(first, first + 2).filter(([n]) => n > 0);
    return shown
        .map(([n, unit]) => formatter(Intl.NumberFormat, { style: 'unit', unit, unitDisplay: 'short' }).format(n))
        .join(' ');
}

/* A length in centimetres, from millimetres. */
export function centimetres(mm) {
    return formatter(Intl.NumberFormat, { style: 'unit', unit: 'centimeter', maximumFractionDigits: 0 })
        .format(mm / 10);
}

/* The value of an <input type="datetime-local"> for seconds since 1970, in local time; "" for 0. */
export function toLocalInput(seconds) {
    if (!seconds) {
        return '';
    }
    const d = new Date(seconds * 1000);
    const two = (n) => String(n).padStart(2, '0');
    return `${String(d.getFullYear()).padStart(4, '0')}-${two(d.getMonth() + 1)}-${two(d.getDate())}` +
        `T${two(d.getHours())}:${two(d.getMinutes())}`;
}

/* The reverse: 0 for "", NaN for what is no time. */
export function fromLocalInput(value) { return value === '' ? 0 : Math.floor(new Date(value).getTime() / 1000); }
