#include "enroll/web/update/update.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/image/update_text.h"
#include "enroll/web/calls/call_queue.h"
#include "enroll/web/update/last_update.h"
#include "firmware/contract/bus_connect.h"

/* RAUC has to be started first, and asks the boot loader for its entries. */
static const uint64_t call_us = UINT64_C(30000000);

static const sd_bus_error is_gone = SD_BUS_ERROR_MAKE_CONST(SD_BUS_ERROR_DISCONNECTED,
                                                            "There is no bus.");

struct web_update {
    struct web_update_setup setup;
    struct web_upload upload;
    struct web_call_queue *calls;
    sd_bus *bus; /* NULL: not connected */
};

/* Somebody looks: GetAll, then GetSlotStatus and GetPrimary unless RAUC is at work. */
struct look {
    struct web_update *update;
    void (*on_seen)(void *context, json_t *state);
    void *context;
    struct cli_installer_state state;
    struct cli_slots slots;
};

/* ---- the state ---- */

static json_t *describe(const struct look *look)
{
    const struct web_upload *upload = &look->update->upload;
    struct cli_update_view view = {.state = &look->state, .slots = look->slots};
    json_t *state;

    cli_os_release_read(look->update->setup.os_release, &view.running);
    state = cli_update_json(&view);
    json_t *more = json_pack("{s:b, s:b, s:I, s:o}", "coming", web_upload_is_coming(upload),
                             "handed_over", web_upload_is_handed_over(upload), "most_bytes",
                             (json_int_t)web_upload_room(upload), "last",
                             web_last_update(look->update->setup.folder));
    if (!state || json_object_update(state, more) < 0) {
        json_decref(state);
        state = NULL;
    }
    json_decref(more);
    return state;
}

/* `hindrance`: why the machine takes no updates by the pages; NULL: it does. */
static void finish(struct look *look, const char *hindrance)
{
    json_t *state = describe(look);
    json_t *word = hindrance ? json_string(hindrance) : json_null();

    if (state && json_object_set_new(state, "hindrance", word) < 0) {
        json_decref(state);
        state = NULL;
    }
    look->on_seen(look->context, state);
    free(look);
}

static const char *hindrance_of(const sd_bus_error *error)
{
    if (sd_bus_error_has_name(error, SD_BUS_ERROR_SERVICE_UNKNOWN) ||
        sd_bus_error_has_name(error, SD_BUS_ERROR_NAME_HAS_NO_OWNER)) {
        return "no-image";
    }
    return sd_bus_error_has_name(error, SD_BUS_ERROR_ACCESS_DENIED) ? "denied" : "no-reply";
}

/* ---- RAUC ---- */

static void ask(struct look *look, const char *interface, const char *method,
                web_call_reply_fn on_reply)
{
    struct web_update *update = look->update;
    sd_bus_message *call = NULL;

    if (update->bus && sd_bus_message_new_method_call(update->bus, &call, CLI_RAUC, CLI_RAUC_PATH,
                                                      interface, method) >= 0) {
        const bool has_word = strcmp(method, "GetAll") == 0;
        if (has_word && sd_bus_message_append(call, "s", CLI_RAUC_INTERFACE) < 0) {
            call = sd_bus_message_unref(call);
        }
    }
    const struct web_call_request request = {
        .message = call, .timeout_us = call_us, .on_reply = on_reply, .context = look};
    web_call_queue_send(update->calls, &request);
}

/* If the boot loader can start nothing, RAUC answers with an error, and no slot is the next. */
static void on_primary(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct look *look = context;

    if (!error) {
        cli_rauc_read_primary(reply, &look->slots);
    }
    finish(look, NULL);
}

/* RAUC may have begun to install between the two questions, and then refuses to answer. */
static void on_slots(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct look *look = context;

    if (error || cli_rauc_read_slots(reply, &look->slots) < 0) {
        look->slots.n = 0;
        finish(look, NULL);
        return;
    }
    ask(look, CLI_RAUC_INTERFACE, "GetPrimary", on_primary);
}

static void on_state(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct look *look = context;

    if (error || cli_rauc_read_state(reply, &look->state) < 0) {
        finish(look, error ? hindrance_of(error) : "no-reply");
    } else if (cli_rauc_is_busy(&look->state)) {
        finish(look, NULL);
    } else {
        ask(look, CLI_RAUC_INTERFACE, "GetSlotStatus", on_slots);
    }
}

static void on_no_image(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    (void)reply, (void)error;
    finish(context, "no-image");
}

/* ---- the connection ---- */

static void disconnect(struct web_update *update)
{
    web_call_queue_drop(update->calls);
    if (update->bus) {
        (void)sd_bus_detach_event(update->bus);
        update->bus = sd_bus_close_unref(update->bus);
    }
    web_call_queue_fail(update->calls);
}

static void connect_if_needed(struct web_update *update)
{
    if (update->bus && sd_bus_is_open(update->bus) <= 0) {
        disconnect(update);
    }
    if (!update->bus && iso_bus_connect(update->setup.bus, &update->bus) >= 0 &&
        sd_bus_attach_event(update->bus, update->setup.event, SD_EVENT_PRIORITY_NORMAL) < 0) {
        update->bus = sd_bus_close_unref(update->bus);
    }
}

void web_update_look(struct web_update *update, void (*on_seen)(void *context, json_t *state),
                     void *context)
{
    struct look *look = calloc(1, sizeof *look);

    if (!look) {
        on_seen(context, NULL);
        return;
    }
    *look = (struct look){.update = update, .on_seen = on_seen, .context = context};
    if (web_upload_is_possible(&update->upload)) {
        connect_if_needed(update);
        ask(look, "org.freedesktop.DBus.Properties", "GetAll", on_state);
        return;
    }
    const struct web_call_request nobody = {.on_reply = on_no_image, .context = look};
    web_call_queue_send(update->calls, &nobody);
}

/* ---- begin and end ---- */

int web_update_new(const struct web_update_setup *setup, struct web_update **out)
{
    struct web_update *update = calloc(1, sizeof *update);

    if (!update) {
        return -ENOMEM;
    }
    update->setup = *setup;
    web_upload_init(&update->upload, setup->folder);
    const int r = web_call_queue_new(setup->event, &is_gone, &update->calls);
    if (r < 0) {
        free(update);
        return r;
    }
    *out = update;
    return 0;
}

struct web_upload *web_update_upload(struct web_update *update)
{
    return &update->upload;
}

void web_update_close(struct web_update *update)
{
    disconnect(update);
    web_call_queue_fail(update->calls); /* questions that were asked because of the answers */
}

void web_update_free(struct web_update *update)
{
    if (update) {
        web_update_close(update);
        web_upload_drop(&update->upload, update->upload.owner);
        web_call_queue_free(update->calls);
        free(update);
    }
}
