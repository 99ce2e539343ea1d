/* The messages of the hub of the rig. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/puppets.h"

/* ---- messages of the hub ---- */

enum iso_fleet_outcome door_rig_give(struct door_rig *rig, struct iso_fleet_bytes message)
{
    enum iso_fleet_outcome outcome = ISO_FLEET_OUTCOMES;
    struct iso_fleet_id zone;
    rig->fault.text[0] = '\0';
    (void)!iso_fleet_receive(rig->fleet, message.bytes, message.size, &outcome, &zone, &rig->fault);
    iso_fleet_bytes_free(&message);
    return outcome; /* ISO_FLEET_OUTCOMES: an error */
}

struct iso_fleet_bytes door_rig_lease(struct door_rig *rig, size_t n)
{
    struct iso_fleet_bytes out = {.bytes = NULL}, asked = {.bytes = NULL};
    struct iso_fleet_question question;
    struct iso_fleet_lease lease = {.door = rig->door,
                                    .lease_s = rig->lease_s,
                                    .local_people = rig->local_people,
                                    .acked = rig->acked,
                                    .n = n};
    assert_int_equal(iso_fleet_question(rig->fleet, &asked, NULL), 0);
    assert_int_equal(
        iso_fleet_read_question(asked.bytes, asked.size, rig->door_signs.public, &question), 0);
    memcpy(lease.nonce, question.nonce, sizeof lease.nonce);
    for (size_t i = 0; i < n; i++) {
        lease.places[i] = rig->zone[i].place;
    }
    assert_int_equal(iso_fleet_make_lease(&lease, &rig->hub, &out), 0);
    iso_fleet_bytes_free(&asked);
    return out;
}

enum iso_fleet_outcome door_rig_answer(struct door_rig *rig, size_t n)
{
    return door_rig_give(rig, door_rig_lease(rig, n));
}

struct iso_fleet_bytes door_rig_key(const struct door_rig *rig, int zone)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    const struct iso_fleet_key_grant grant = {.door = rig->door,
                                              .base = rig->zone[zone].base,
                                              .reset = rig->zone[zone].reset,
                                              .key = rig->zone[zone].key};
    assert_int_equal(iso_fleet_make_key(&grant, rig->door_receives.public, &rig->hub, &out), 0);
    return out;
}

void door_rig_begin(struct door_rig *rig, size_t n)
{
    assert_int_equal(door_rig_answer(rig, n), ISO_FLEET_APPLIED);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(door_rig_give(rig, door_rig_key(rig, (int)i)), ISO_FLEET_APPLIED);
    }
}

struct iso_fleet_id door_rig_id(int person)
{
    return iso_fleet_id_of(&person, sizeof person);
}

static struct iso_fleet_bytes bytes_of(const struct iso_fleet_change *change)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    iso_fleet_put_change(&out, change);
    assert_int_equal(out.error, 0);
    return out;
}

static struct iso_fleet_bytes put_change(int person, uint64_t revision, const char *name, int face,
                                         bool offline_ok)
{
    static uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    struct iso_fleet_change change = {
        .kind = ISO_FLEET_PUT,
        .person = {.id = door_rig_id(person),
                   .revision = revision,
                   .offline_ok = offline_ok,
                   .enrolled_s = 500,
                   .name = name,
                   .name_length = strlen(name)},
    };
    if (face) {
        const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
        const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
        assert_true(size > 0);
        change.person.n = 1;
        change.person.templates[0] = (struct iso_fleet_template){PUPPET_ALGORITHM, (uint32_t)size,
                                                                 bytes};
    }
    return bytes_of(&change);
}

struct iso_fleet_bytes door_rig_change(int person, uint64_t revision, const char *name, int face)
{
    return put_change(person, revision, name, face, false);
}

/* Makes the next delta of a zone, and frees the change. */
static struct iso_fleet_bytes delta_of(struct door_rig *rig, int zone,
                                       struct iso_fleet_bytes change)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    struct iso_fleet_place *place = &rig->zone[zone].place;
    struct iso_fleet_delta delta = {.place = *place};
    memcpy(delta.before, place->digest, sizeof delta.before);
    delta.place.sequence++;
    assert_int_equal(iso_fleet_make_delta(&delta, change.bytes, change.size, &rig->zone[zone].key,
                                          &rig->hub, &out),
                     0);
    *place = delta.place;
    iso_fleet_bytes_free(&change);
    return out;
}

struct iso_fleet_bytes door_rig_put(struct door_rig *rig, int zone, int person, uint64_t revision,
                                    const char *name, int face, bool offline_ok)
{
    return delta_of(rig, zone, put_change(person, revision, name, face, offline_ok));
}

struct iso_fleet_bytes door_rig_remove(struct door_rig *rig, int zone, int person,
                                       uint64_t revision)
{
    const struct iso_fleet_change change = {
        .kind = ISO_FLEET_REMOVE, .person = {.id = door_rig_id(person), .revision = revision}};
    return delta_of(rig, zone, bytes_of(&change));
}

struct iso_fleet_bytes door_rig_policy(struct door_rig *rig, int zone, const char *json)
{
    const struct iso_fleet_change change = {
        .kind = ISO_FLEET_POLICY, .policy = json, .policy_length = strlen(json)};
    return delta_of(rig, zone, bytes_of(&change));
}

struct iso_fleet_bytes door_rig_lock(struct door_rig *rig, int zone, bool on)
{
    const struct iso_fleet_change change = {.kind = ISO_FLEET_LOCKDOWN, .lockdown = on};
    return delta_of(rig, zone, bytes_of(&change));
}

static int gather(void *context, const void *bytes, size_t size)
{
    struct iso_fleet_bytes *out = context;
    iso_fleet_put(out, bytes, size);
    return out->error;
}

struct iso_fleet_bytes door_rig_snapshot(const struct door_rig *rig, int zone,
                                         struct iso_fleet_bytes *changes, size_t n)
{
    struct iso_fleet_bytes out = {.bytes = NULL};
    struct iso_fleet_snapshot_writer writer = {.write = gather, .context = &out};
    assert_int_equal(
        iso_fleet_snapshot_begin(&writer, &rig->zone[zone].place, 1, &rig->zone[zone].key), 0);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(iso_fleet_snapshot_add(&writer, changes[i].bytes, changes[i].size), 0);
        iso_fleet_bytes_free(&changes[i]);
    }
    assert_int_equal(iso_fleet_snapshot_end(&writer, &rig->hub), 0);
    return out;
}

enum iso_fleet_outcome door_rig_give_snapshot(struct door_rig *rig, struct iso_fleet_bytes file)
{
    enum iso_fleet_outcome outcome = ISO_FLEET_OUTCOMES;
    struct iso_fleet_id zone;
    FILE *temporary = tmpfile();
    assert_non_null(temporary);
    if (file.size > 0) {
        assert_int_equal(fwrite(file.bytes, 1, file.size, temporary), file.size);
    }
    assert_int_equal(fflush(temporary), 0);
    rig->fault.text[0] = '\0';
    (void)!iso_fleet_snapshot_file(rig->fleet, fileno(temporary), &outcome, &zone, &rig->fault);
    assert_int_equal(fclose(temporary), 0);
    iso_fleet_bytes_free(&file);
    return outcome;
}
