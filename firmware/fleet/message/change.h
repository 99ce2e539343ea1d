/* One change of a zone, as the doors apply it: the plain text of a delta, and one part of a
 * snapshot. Pure.
 *
 *   kind u8, then
 *   PUT       person[16], revision u64, flags u8, valid_from i64, valid_until i64, enrolled i64,
 *             name text, credential text, n u8, n times: algorithm u32, size u32, bytes
 *   REMOVE    person[16], revision u64
 *   POLICY    document text ("": no policy)
 *   LOCKDOWN  on u8
 *
 * A text is its length as u32 and its bytes. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_CHANGE_H
#define ISO_FIRMWARE_FLEET_MESSAGE_CHANGE_H

#include <stdbool.h>

#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"

/* The numbers are in the messages. */
enum iso_fleet_change_kind {
    ISO_FLEET_PUT = 1,
    ISO_FLEET_REMOVE = 2,
    ISO_FLEET_POLICY = 3,
    ISO_FLEET_LOCKDOWN = 4,
};

enum {
    ISO_FLEET_TEMPLATES_MAX = 32,          /* of one person: those of two algorithms */
    ISO_FLEET_NAME_MAX = 256,              /* bytes */
    ISO_FLEET_CREDENTIAL_MAX = 4096,       /* bytes */
    ISO_FLEET_POLICY_MAX = (2 << 20) - 64, /* bytes */
    ISO_FLEET_TEMPLATE_MAX = 64 << 10,     /* bytes of one template */
};

/* A template as iso_template_serialise() makes it. The bytes belong to somebody else. */
struct iso_fleet_template {
    uint32_t algorithm, size;
    const uint8_t *bytes;
};

/* A person of a fleet. The texts lie in the message and are not terminated. */
struct iso_fleet_person {
    struct iso_fleet_id id;
    uint64_t revision; /* rises with each change of anybody in the fleet. A PUT with a smaller one
                        * than the stored one is old: another zone was faster */
    bool offline_ok;   /* is admitted without a lease */
    int64_t valid_from_s, valid_until_s, enrolled_s; /* since 1970; limits: 0 means none */
    const char *name;
    size_t name_length;
    const char *credential; /* JSON as credential_json.h writes it; length 0: the default */
    size_t credential_length;
    size_t n;
    struct iso_fleet_template templates[ISO_FLEET_TEMPLATES_MAX];
};

struct iso_fleet_change {
    enum iso_fleet_change_kind kind;
    struct iso_fleet_person person; /* PUT; of REMOVE only id and revision */
    const char *policy;             /* POLICY; not terminated */
    size_t policy_length;
    bool lockdown; /* LOCKDOWN */
};

/* Appends a change; errors are in out->error. */
void iso_fleet_put_change(struct iso_fleet_bytes *out, const struct iso_fleet_change *change);

/* Reads one change that fills all the bytes, in which its texts and templates stay. -EBADMSG it is
 * none or has a field out of range, -EPROTONOSUPPORT a kind of a newer version. */
int iso_fleet_read_change(const void *bytes, size_t size, struct iso_fleet_change *out)
    __attribute__((warn_unused_result));

/* A person alone, as a REQUEST contains it: the fields of PUT. */
void iso_fleet_put_person(struct iso_fleet_bytes *out, const struct iso_fleet_person *person);
int iso_fleet_read_person(const void *bytes, size_t size, struct iso_fleet_person *out)
    __attribute__((warn_unused_result));

/* The digest of the templates of a person: algorithm, size and bytes of each, in their order. */
void iso_fleet_templates_digest(const struct iso_fleet_person *person,
                                uint8_t digest[ISO_FLEET_DIGEST_BYTES]);

#endif
