/* Search by name: a text is compared without regard to case, accents and blanks at its ends. Pure. */

/* Letters that have no decomposition of Unicode, as people type them without the accent. */
const LETTERS = {
    ß: 'ss',
    ø: 'o',
    đ: 'd',
    ł: 'l',
    æ: 'ae',
    œ: 'oe',
    ı: 'i',
    ħ: 'h'
};

/* The form of a text for comparisons. Arabic vowel signs are dropped, too: people do not type them. */
export function fold(text) {
    return String(text)
        .normalize('NFKD')
        .replace(/\p{M}/gu, '')
        .toLowerCase()
        .replace(/[ßøđłæœıħ]/g, (letter) => LETTERS[letter])
        .trim();
}

/* A test for names: whether each word of `query` is in the name. An empty query takes all names. */
export function matcher(query) {
    const words = fold(query).split(/\s+/).filter(Boolean);
    return (folded) => words.every((word) => folded.includes(word));
}

/* Two spellings with one key are one person's name, as firmware/contract/name_folding.h defines it:
 * case and the encoding of a character make no difference, accents do. */
export function nameKey(name) { return String(name).normalize('NFKD').toUpperCase().toLowerCase().normalize('NFKC'); }
