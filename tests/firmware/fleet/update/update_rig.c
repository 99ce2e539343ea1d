#include "tests/firmware/fleet/update/update_rig.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/fleet/update/update_inner.h"
#include "tests/support/scratch.h"

enum { LIMIT_S = 120 };

/* ---- the daemon ---- */

static int update(void *context, const struct iso_fleet_update_report *report, bool *busy,
                  struct iso_fault *fault)
{
    struct update_rig *rig = context;
    if (rig->is_away) {
        return iso_fault_set(fault, -ENOTCONN, "away");
    }
    assert_true(report->is_known);
    rig->tells++;
    rig->told = report->state;
    *busy = rig->is_busy;
    return 0;
}

/* The body of the request is the offset, which the daemon would sign. */
static int fetch_update(void *context, const struct iso_fleet_id *rollout, uint64_t after,
                        struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    struct update_rig *rig = context;
    (void)fault;
    assert_true(iso_fleet_id_is_same(rollout, &rig->order.rollout));
    iso_fleet_put_u64(out, after);
    return out->error;
}

/* ---- the hub ---- */

static void answer(void *context, const char *path, const void *body, size_t size,
                   struct fetch_answer *out)
{
    struct update_rig *rig = context;
    struct iso_fleet_reader in = {.bytes = body, .left = size};
    assert_string_equal(path, "/fleet/v1/fetch");
    rig->last_after = iso_fleet_take_u64(&in);
    const uint64_t left = UPDATE_FILE_BYTES - rig->last_after;
    rig->begins += rig->last_after == 0;
    out->status = rig->cut_at && rig->last_after >= rig->cut_at ? 503 : rig->status;
    if (out->status != 200) {
        return;
    }
    out->size = left < ISO_FLEET_UPDATE_PART_BYTES ? (size_t)left : ISO_FLEET_UPDATE_PART_BYTES;
    out->bytes = malloc(out->size);
    assert_non_null(out->bytes);
    memcpy(out->bytes, rig->file + rig->last_after, out->size);
    if (rig->is_damaged || rig->begins <= rig->damaged) {
        *(uint8_t *)out->bytes ^= 1;
    }
}

/* ---- isotherm(1) ---- */

/* What `isotherm update --json` says next. */
void update_rig_slots(struct update_rig *rig, const char *version, bool good, bool waiting)
{
    update_rig_slots_with(rig, version, "", good, waiting);
}

void update_rig_slots_with(struct update_rig *rig, const char *version, const char *other,
                           bool good, bool waiting)
{
    char path[320], text[480];
    (void)snprintf(path, sizeof path, "%s/slots", rig->folder);
    (void)snprintf(
        text, sizeof text,
        "{\"image\": \"isotherm-pc-usb\", \"board\": \"" UPDATE_BOARD "\", \"version\": "
        "\"%s\", \"proven\": %s, \"operation\": \"idle\", \"percent\": 0, \"slots\": [{\"slot\": "
        "\"a\", "
        "\"version\": \"%s\", \"running\": true, \"good\": %s, \"next\": %s}, {\"slot\": "
        "\"b\", \"version\": \"%s\", \"running\": false, \"good\": true, \"next\": %s}]}\n",
        version, rig->is_on_trial ? "false" : "true", version, good ? "true" : "false",
        waiting ? "false" : "true", other, waiting ? "true" : "false");
    scratch_write_text(path, text);
}

static void write_program(const struct update_rig *rig, const char *name, const char *text)
{
    char path[340];
    (void)snprintf(path, sizeof path, "%s/%s", rig->bin, name);
    scratch_write_text(path, text);
    assert_int_equal(chmod(path, 0700), 0);
}

/* The script copies what it installs, and says what `isotherm update --json FILE` would. Each line
 * of the file "refusals" is the code of one refusal; the last one stays. */
void update_rig_program(struct update_rig *rig, const char *refusals)
{
    char text[1600], path[320];
    (void)snprintf(
        text, sizeof text,
        "#!/bin/sh\n[ \"$1 $2\" = 'update --json' ] || exit 9\ncd %s\n"
        "if [ $# = 2 ]; then [ -e slots ] || exit 3; cat slots; exit 0; fi\n"
        "code=$(head -n 1 refusals); [ \"$(wc -l <refusals)\" -le 1 ] || sed -i 1d refusals\n"
        "echo \"$code\" >>asked\n"
        "if [ -n \"$code\" ]; then printf '{\"error\":{\"code\":\"%%s\",\"message\":\"refused: "
        "%%s\",\"exit_code\":1}}' \"$code\" \"$code\"; exit 1; fi\n"
        "cp \"$3\" installed\n[ ! -e slots.after ] || mv slots.after slots\n"
        "echo '{\"installed\": true, \"slot\": \"b\", \"version\": \"1.2\"}'\n",
        rig->folder);
    write_program(rig, "isotherm", text);
    (void)snprintf(path, sizeof path, "%s/refusals", rig->folder);
    scratch_write_text(path, refusals);
    write_program(rig, "busctl", "#!/bin/sh\n");
}

/* What isotherm-update@hub.path and its service do. */
static void play_image(struct update_rig *rig)
{
    char bundle[340], command[1200];
    (void)snprintf(bundle, sizeof bundle, "%s/hub/bundle.raucb", rig->state);
    if (rig->has_no_units || !scratch_exists(bundle)) {
        return;
    }
    (void)snprintf(command, sizeof command,
                   "PATH='%s':$PATH ISOTHERM_ROOT='%s' '" ISOTHERM_SOURCE_DIR
                   "/board/image/programs/install-update' hub '%s' >/dev/null",
                   rig->bin, rig->folder, bundle);
    assert_int_equal(system(command), 0);
    assert_false(scratch_exists(bundle));
}

void update_rig_turn(struct update_rig *rig)
{
    assert_true(sd_event_run(rig->event, 100000) >= 0);
    play_image(rig);
}

/* ---- the rig ---- */

void update_rig_start(struct update_rig *rig)
{
    const struct link_update_setup setup = {
        .event = rig->event,
        .daemon = {.context = rig, .update = update, .fetch_update = fetch_update},
        .http = rig->http,
        .hub_url = rig->server.url,
        .folder = rig->folder,
        .updates = rig->state,
        .program = rig->program,
        .retry_ms = 100};
    struct iso_fault fault = {.text = ""};
    assert_int_equal(link_update_new(&setup, &rig->update, &fault), 0);
}

void update_rig_stop(struct update_rig *rig)
{
    link_update_free(rig->update);
    rig->update = NULL;
}

int update_rig_setup(void **state)
{
    struct update_rig *rig = calloc(1, sizeof *rig);
    void *folder = NULL;
    char command[700];
    struct iso_fault fault = {.text = ""};
    assert_non_null(rig);
    assert_int_equal(scratch_setup(&folder), 0);
    (void)snprintf(rig->folder, sizeof rig->folder, "%s", (const char *)folder);
    free(folder);
    (void)snprintf(rig->state, sizeof rig->state, "%s/var/lib/isotherm-update", rig->folder);
    (void)snprintf(rig->bin, sizeof rig->bin, "%s/bin", rig->folder);
    (void)snprintf(rig->program, sizeof rig->program, "%s/isotherm", rig->bin);
    (void)snprintf(rig->restart, sizeof rig->restart, "%s/hub/restart", rig->state);
    (void)snprintf(command, sizeof command, "mkdir -p '%s/hub' '%s'", rig->state, rig->bin);
    assert_int_equal(system(command), 0);
    assert_true(sd_event_new(&rig->event) >= 0);
    assert_int_equal(link_http_new(rig->event, &rig->http, &fault), 0);
    rig->server.context = rig;
    rig->server.answer = answer;
    rig->status = 200;
    fetch_server_start(&rig->server, rig->event, NULL, NULL);
    rig->file = malloc(UPDATE_FILE_BYTES);
    assert_non_null(rig->file);
    randombytes_buf(rig->file, UPDATE_FILE_BYTES);
    rig->order = (struct iso_fleet_update){.rollout = iso_fleet_id_random(),
                                           .size = UPDATE_FILE_BYTES,
                                           .version = "1.2",
                                           .board = UPDATE_BOARD};
    (void)crypto_hash_sha256(rig->order.sha256, rig->file, UPDATE_FILE_BYTES);
    update_rig_program(rig, "\n");
    *state = rig;
    return 0;
}

int update_rig_teardown(void **state)
{
    struct update_rig *rig = *state;
    char command[300];
    update_rig_stop(rig);
    fetch_server_stop(&rig->server);
    link_http_free(rig->http);
    (void)sd_event_unref(rig->event);
    free(rig->file);
    (void)snprintf(command, sizeof command, "rm -rf '%s'", rig->folder);
    const int status = system(command);
    free(rig);
    return status;
}

bool update_rig_is_told(const struct update_rig *rig, enum iso_fleet_update_state state)
{
    return rig->tells > 0 && rig->told == state && link_update_report(rig->update)->state == state;
}

/* Runs the loop until the daemon was told this. */
void update_rig_wait(struct update_rig *rig, enum iso_fleet_update_state state)
{
    uint64_t begun, now;
    assert_true(sd_event_now(rig->event, CLOCK_MONOTONIC, &begun) >= 0);
    while (!update_rig_is_told(rig, state)) {
        update_rig_turn(rig);
        assert_true(sd_event_now(rig->event, CLOCK_MONOTONIC, &now) >= 0);
        if (now - begun > LIMIT_S * LINK_UPDATE_S_US) {
            fail_msg("told %s: %s", iso_fleet_update_state_word(rig->told),
                     link_update_report(rig->update)->fault);
        }
    }
}

void update_rig_run(struct update_rig *rig, unsigned requests)
{
    while (rig->server.requests < requests) {
        update_rig_turn(rig);
    }
}

bool update_rig_has(const struct update_rig *rig, const char *name)
{
    char path[320];
    (void)snprintf(path, sizeof path, "%s/%s", rig->folder, name);
    return scratch_exists(path);
}

void update_rig_expect_installed(struct update_rig *rig)
{
    char path[320];
    size_t size = 0;
    (void)snprintf(path, sizeof path, "%s/installed", rig->folder);
    uint8_t *bytes = scratch_read(path, &size);
    assert_int_equal(size, UPDATE_FILE_BYTES);
    assert_memory_equal(bytes, rig->file, size);
    free(bytes);
}

/* The hub answers a question, and orders. */
void update_rig_order(struct update_rig *rig)
{
    link_update_answered(rig->update);
    link_update_ordered(rig->update, &rig->order);
}

void update_rig_begin(struct update_rig *rig, const char *refusals)
{
    update_rig_slots(rig, "1.1", true, false);
    update_rig_program(rig, refusals);
    update_rig_start(rig);
    update_rig_wait(rig, ISO_FLEET_UPDATE_IDLE);
    update_rig_order(rig);
}
