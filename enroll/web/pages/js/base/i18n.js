/* The language of the pages: texts are English in the sources and have a translation in a catalogue
 * of gettext, which is loaded from locale/LANG.mo. */

import {parseCatalogue} from './mo.js';

/* The languages, each by its own name. */
export const LANGUAGES = {
    en: 'English',
    de: 'Deutsch',
    es: 'Español',
    fr: 'Français',
    ar: 'العربية',
    zh_CN: '简体中文',
};

const STORED = 'isotherm-language';
const state = {
    language: 'en',
    catalogue: new Map()
};

/* Marks a text for the catalogues and leaves it as it is. */
export const N_ = (text) => text;

/* The translation of a text. */
export function _(text) { return state.catalogue.get(text) || text; }

/* Puts values into the places of a text: "{name}". A place without a value stays as it is. */
export function place(text, values) {
    return text.replace(/\{(\w+)\}/g, (whole, name) => (name in values ? String(values[name]) : whole));
}

/* The translation of a text with values in its places. */
export function _f(text, values) { return place(_(text), values); }

/* The first language of a list of BCP 47 tags that has a catalogue; "en" if none has. Traditional
 * Chinese is not simplified Chinese. */
export function chooseLanguage(tags) {
    for (const tag of tags) {
        const parts = String(tag).toLowerCase().replaceAll('_', '-').split('-');
        if (parts[0] === 'zh') {
            if (!parts.some((part) => ['hant', 'tw', 'hk', 'mo'].includes(part))) {
                return 'zh_CN';
            }
        } else if (Object.hasOwn(LANGUAGES, parts[0])) {
            return parts[0];
        }
    }
    return 'en';
}

/* The tag of the language for `lang` and Intl. */
export function languageTag() { return state.language.replace('_', '-'); }

export function language() { return state.language; }

function stored() {
    try {
        return localStorage.getItem(STORED);
    } catch {
        return null; /* the browser stores nothing */
    }
}

/* Keeps the choice for later. It is not lost if the browser stores nothing; it then holds until the
 * page is closed. */
export function storeLanguage(name) {
    try {
        localStorage.setItem(STORED, name);
    } catch {
        /* nothing is stored */
    }
}

/* Loads a language; a catalogue that cannot be loaded leaves the texts English. */
export async function loadLanguage(name) {
    state.catalogue = new Map();
    state.language = 'en';
    if (name !== 'en' && Object.hasOwn(LANGUAGES, name)) {
        try {
            const url = new URL(`../../locale/${name}.mo`, import.meta.url);
            const response = await fetch(url);
            if (!response.ok) {
                throw new Error(`status ${response.status}`);
            }
            state.catalogue = parseCatalogue(new Uint8Array(await response.arrayBuffer()));
            state.language = name;
        } catch (error) {
            console.warn(`no catalogue ${name}:`, error);
        }
    }
    document.documentElement.lang = languageTag();
    document.documentElement.dir = state.language === 'ar' ? 'rtl' : 'ltr';
}

/* Loads the language that was chosen before, or that of the browser. */
export function loadPreferredLanguage(preferred = navigator.languages ?? []) {
    return loadLanguage(chooseLanguage([stored(), ...preferred].filter(Boolean)));
}
