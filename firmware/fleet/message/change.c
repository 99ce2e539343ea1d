#include "firmware/fleet/message/change.h"

#include <errno.h>
#include <sodium.h>

#include "core/base/bytes.h"

enum { FLAG_OFFLINE_OK = 1 };

static void put_counted(struct iso_fleet_bytes *out, const char *text, size_t length)
{
    iso_fleet_put_u32(out, (uint32_t)length);
    iso_fleet_put(out, text, length);
}

void iso_fleet_put_person(struct iso_fleet_bytes *out, const struct iso_fleet_person *person)
{
    iso_fleet_put(out, person->id.bytes, sizeof person->id.bytes);
    iso_fleet_put_u64(out, person->revision);
    iso_fleet_put_u8(out, person->offline_ok ? FLAG_OFFLINE_OK : 0);
    iso_fleet_put_u64(out, (uint64_t)person->valid_from_s);
    iso_fleet_put_u64(out, (uint64_t)person->valid_until_s);
    iso_fleet_put_u64(out, (uint64_t)person->enrolled_s);
    put_counted(out, person->name, person->name_length);
    put_counted(out, person->credential, person->credential_length);
    iso_fleet_put_u8(out, (uint8_t)person->n);
    for (size_t i = 0; i < person->n; i++) {
        iso_fleet_put_u32(out, person->templates[i].algorithm);
        iso_fleet_put_u32(out, person->templates[i].size);
        iso_fleet_put(out, person->templates[i].bytes, person->templates[i].size);
    }
}

void iso_fleet_put_change(struct iso_fleet_bytes *out, const struct iso_fleet_change *change)
{
    iso_fleet_put_u8(out, (uint8_t)change->kind);
    switch (change->kind) {
    case ISO_FLEET_PUT:
        iso_fleet_put_person(out, &change->person);
        break;
    case ISO_FLEET_REMOVE:
        iso_fleet_put(out, change->person.id.bytes, sizeof change->person.id.bytes);
        iso_fleet_put_u64(out, change->person.revision);
        break;
    case ISO_FLEET_POLICY:
        put_counted(out, change->policy, change->policy_length);
        break;
    case ISO_FLEET_LOCKDOWN:
        iso_fleet_put_u8(out, change->lockdown ? 1 : 0);
        break;
    }
}

static void take_templates(struct iso_fleet_reader *in, struct iso_fleet_person *person)
{
    person->n = iso_fleet_take_u8(in);
    if (person->n > ISO_FLEET_TEMPLATES_MAX) {
        in->bad = true;
    }
    for (size_t i = 0; !in->bad && i < person->n; i++) {
        struct iso_fleet_template *own = &person->templates[i];
        own->algorithm = iso_fleet_take_u32(in);
        own->size = iso_fleet_take_u32(in);
        if (own->size > ISO_FLEET_TEMPLATE_MAX) {
            in->bad = true;
        }
        own->bytes = iso_fleet_take(in, own->size);
    }
}

/* Reads a flag or a switch: a byte that is 0 or 1. */
static bool take_switch(struct iso_fleet_reader *in)
{
    const uint8_t value = iso_fleet_take_u8(in);
    if (value > 1) {
        in->bad = true;
    }
    return value == 1;
}

static void take_person(struct iso_fleet_reader *in, struct iso_fleet_person *person)
{
    iso_fleet_take_bytes(in, person->id.bytes, sizeof person->id.bytes);
    person->revision = iso_fleet_take_u64(in);
    person->offline_ok = take_switch(in);
    person->valid_from_s = (int64_t)iso_fleet_take_u64(in);
    person->valid_until_s = (int64_t)iso_fleet_take_u64(in);
    person->enrolled_s = (int64_t)iso_fleet_take_u64(in);
    person->name = iso_fleet_take_text(in, ISO_FLEET_NAME_MAX, &person->name_length);
    person->credential = iso_fleet_take_text(in, ISO_FLEET_CREDENTIAL_MAX,
                                             &person->credential_length);
    if (person->valid_from_s < 0 || person->valid_until_s < 0 || person->name_length == 0) {
        in->bad = true;
    }
    take_templates(in, person);
}

int iso_fleet_read_person(const void *bytes, size_t size, struct iso_fleet_person *out)
{
    struct iso_fleet_reader in = {.bytes = bytes, .left = size};
    struct iso_fleet_person person = {.n = 0};
    take_person(&in, &person);
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    *out = person;
    return 0;
}

int iso_fleet_read_change(const void *bytes, size_t size, struct iso_fleet_change *out)
{
    struct iso_fleet_reader in = {.bytes = bytes, .left = size};
    struct iso_fleet_change change = {.kind = (enum iso_fleet_change_kind)iso_fleet_take_u8(&in)};
    switch (change.kind) {
    case ISO_FLEET_PUT:
        take_person(&in, &change.person);
        break;
    case ISO_FLEET_REMOVE:
        iso_fleet_take_bytes(&in, change.person.id.bytes, sizeof change.person.id.bytes);
        change.person.revision = iso_fleet_take_u64(&in);
        break;
    case ISO_FLEET_POLICY:
        change.policy = iso_fleet_take_text(&in, ISO_FLEET_POLICY_MAX, &change.policy_length);
        break;
    case ISO_FLEET_LOCKDOWN:
        change.lockdown = take_switch(&in);
        break;
    default:
        return in.bad ? -EBADMSG : -EPROTONOSUPPORT;
    }
    if (!iso_fleet_reader_is_done(&in)) {
        return -EBADMSG;
    }
    *out = change;
    return 0;
}

void iso_fleet_templates_digest(const struct iso_fleet_person *person,
                                uint8_t digest[ISO_FLEET_DIGEST_BYTES])
{
    crypto_generichash_state state;
    (void)crypto_generichash_init(&state, NULL, 0, ISO_FLEET_DIGEST_BYTES);
    for (size_t i = 0; i < person->n; i++) {
        uint8_t head[8];
        (void)iso_put_u32(iso_put_u32(head, person->templates[i].algorithm),
                          person->templates[i].size);
        (void)crypto_generichash_update(&state, head, sizeof head);
        (void)crypto_generichash_update(&state, person->templates[i].bytes,
                                        person->templates[i].size);
    }
    (void)crypto_generichash_final(&state, digest, ISO_FLEET_DIGEST_BYTES);
}
