#include "firmware/access/factor_wait.h"

#include <string.h>

bool iso_factor_wait_is_active(const struct iso_factor_wait *wait)
{
    return wait->person != 0;
}

void iso_factor_wait_end(struct iso_factor_wait *wait)
{
    explicit_bzero(wait, sizeof *wait);
}

static void begin(struct iso_factor_wait *wait, int64_t person, enum iso_recognition method)
{
    iso_factor_wait_end(wait);
    wait->person = person;
    wait->shown.matched = (uint8_t)method;
    wait->by_card = method == ISO_RECOGNITION_CARD;
    wait->changed = true;
}

/* What the last person who came has shown. */
static struct iso_shown *last_shown(struct iso_factor_wait *wait)
{
    return wait->companion ? &wait->companion_shown : &wait->shown;
}

static void forget_keys(struct iso_factor_wait *wait)
{
    wait->keys = 0;
    wait->n_keys = 0;
}

/* Somebody who is not the first person, where a second one is wanted. Returns false if this is a
 * third one. */
static bool take_companion(struct iso_factor_wait *wait, int64_t person,
                           enum iso_recognition method)
{
    if (wait->companion != 0 && wait->companion != person) {
        return false;
    }
    if (wait->companion != person) {
        forget_keys(wait);
    }
    wait->changed |= !(wait->companion_shown.matched & method);
    wait->companion = person;
    wait->companion_shown.matched |= (uint8_t)method;
    return true;
}

/* The first person has shown this, too. */
static void add(struct iso_factor_wait *wait, enum iso_recognition method)
{
    wait->changed |= !(wait->shown.matched & method);
    wait->shown.matched |= (uint8_t)method;
}

bool iso_factor_wait_begins_anew(const struct iso_factor_wait *wait, int64_t person)
{
    const bool second = wait->companion_wanted &&
                        (wait->companion == 0 || wait->companion == person);
    return wait->person != 0 && wait->person != person && !second && !wait->by_card;
}

void iso_factor_wait_face(struct iso_factor_wait *wait, int64_t person)
{
    if (wait->person == person) {
        add(wait, ISO_RECOGNITION_FACE);
    } else if (wait->person != 0 && wait->companion_wanted &&
               take_companion(wait, person, ISO_RECOGNITION_FACE)) {
        return;
    } else if (wait->person != 0 && wait->by_card) {
        wait->shown.differed |= ISO_RECOGNITION_FACE;
    } else {
        begin(wait, person, ISO_RECOGNITION_FACE);
    }
}

void iso_factor_wait_card(struct iso_factor_wait *wait, int64_t holder)
{
    if (wait->person == 0) {
        begin(wait, holder, ISO_RECOGNITION_CARD);
    } else if (wait->person == holder) {
        add(wait, ISO_RECOGNITION_CARD);
    } else if (!wait->companion_wanted || !take_companion(wait, holder, ISO_RECOGNITION_CARD)) {
        last_shown(wait)->differed |= ISO_RECOGNITION_CARD;
    }
}

void iso_factor_wait_strange_card(struct iso_factor_wait *wait)
{
    if (wait->person != 0) {
        last_shown(wait)->differed |= ISO_RECOGNITION_CARD;
    }
}

bool iso_factor_wait_key(struct iso_factor_wait *wait, char key)
{
    if (wait->person == 0) {
        return false;
    }
    if (key == '#') {
        const bool enough = wait->n_keys >= ISO_PIN_DIGITS_MIN;
        if (enough) {
            last_shown(wait)->pin = wait->keys;
            wait->changed = true;
        }
        forget_keys(wait);
        return enough;
    }
    if (key < '0' || key > '9') {
        forget_keys(wait);
    } else if (wait->n_keys < ISO_FACTOR_KEYS_MAX) {
        wait->keys = (wait->n_keys == 0 ? 1 : wait->keys) * 10 + (uint32_t)(key - '0');
        wait->n_keys++;
    }
    return false;
}

void iso_factor_wait_answer(struct iso_factor_wait *wait, const struct iso_access *answer,
                            int64_t now_ns, int64_t wait_ns)
{
    if (answer->outcome != ISO_ACCESS_WANT) {
        iso_factor_wait_end(wait);
        return;
    }
    wait->wanted = answer->wanted;
    wait->companion_wanted = answer->companion_wanted || answer->of_companion;
    wait->until_ns = wait->changed ? now_ns + wait_ns : wait->until_ns;
    wait->changed = false;
}
