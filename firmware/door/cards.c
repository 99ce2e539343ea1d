#include "firmware/door/cards.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"
#include "firmware/contract/person_name.h"

enum { FILE_MAX_BYTES = 1 << 20, FIELD_MAX = 65535 };

struct iso_cards {
    char *text; /* the contents of the file; the names point into it */
    size_t n;
    struct row {
        struct iso_card card;
        struct iso_person_name_key key;
    } rows[];
};

static int parse_count(const char *text, unsigned *out)
{
    size_t count;
    if (iso_text_count(text, &count) || count > FIELD_MAX) {
        return -EINVAL;
    }
    *out = (unsigned)count;
    return 0;
}

/* Cuts the line at its first two blanks. Returns NULL, or what is wrong with the line. */
static const char *parse_row(char *line, struct row *row)
{
    char *number = strchr(line, ' ');
    char *person = number ? strchr(number + 1, ' ') : NULL;
    if (!person) {
        return "not `FACILITY NUMBER NAME`";
    }
    *number++ = '\0';
    *person++ = '\0';
    if (parse_count(line, &row->card.number.facility) ||
        parse_count(number, &row->card.number.number)) {
        return "facility and number are 0 to 65535";
    }
    row->card.person = person;
    const char *flaw = iso_person_name_flaw(person);
    if (flaw) {
        return flaw;
    }
    return iso_person_name_key(person, &row->key) ? "out of memory" : NULL;
}

static const char *find_double(const struct iso_cards *cards, const struct row *row)
{
    for (size_t i = 0; i < cards->n; i++) {
        const struct iso_card *other = &cards->rows[i].card;
        if (strcmp(other->person, row->card.person) == 0) {
            return "this person has a card already";
        }
        if (other->number.facility == row->card.number.facility &&
            other->number.number == row->card.number.number) {
            return "somebody has this card already";
        }
    }
    return NULL;
}

static int parse(const char *path, struct iso_cards *cards, struct iso_fault *fault)
{
    struct iso_text_lines lines = iso_text_lines_of(cards->text);
    for (char *line; (line = iso_text_next_line(&lines));) {
        struct row row;
        if (*line == '\0' || *line == '#') {
            continue;
        }
        const char *what = parse_row(line, &row);
        if (!what) {
            what = find_double(cards, &row);
        }
        if (what) {
            return iso_fault_set_code(fault, ISO_FAULT_CARDS_WRONG, -EBADMSG, "%s:%u: %s", path,
                                      lines.number, what);
        }
        cards->rows[cards->n++] = row;
    }
    return 0;
}

int iso_cards_load(const char *path, struct iso_cards **out, struct iso_fault *fault)
{
    char *text = NULL;
    int error = iso_text_read(path, FILE_MAX_BYTES, &text, fault);
    if (error) {
        return error;
    }
    struct iso_cards *cards = calloc(1, sizeof *cards +
                                            iso_text_line_count(text) * sizeof *cards->rows);
    if (!cards) {
        free(text);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    cards->text = text;
    error = parse(path, cards, fault);
    if (error) {
        iso_cards_free(cards);
        return error;
    }
    *out = cards;
    return 0;
}

void iso_cards_free(struct iso_cards *cards)
{
    if (cards) {
        free(cards->text);
        free(cards);
    }
}

static const struct iso_card *find_spelling(const struct iso_cards *cards, const char *person)
{
    for (size_t i = 0; i < cards->n; i++) {
        if (strcmp(cards->rows[i].card.person, person) == 0) {
            return &cards->rows[i].card;
        }
    }
    return NULL;
}

const struct iso_card *iso_cards_find(const struct iso_cards *cards, const char *person)
{
    struct iso_person_name_key key;
    const struct iso_card *found = find_spelling(cards, person);
    if (found || iso_person_name_key(person, &key)) {
        return found;
    }
    for (size_t i = 0; i < cards->n; i++) {
        if (iso_person_name_key_is_same(&cards->rows[i].key, &key)) {
            if (found) {
                /* Two spellings match the name, and it is not certain which card is this
                 * person's. */
                return NULL;
            }
            found = &cards->rows[i].card;
        }
    }
    return found;
}
