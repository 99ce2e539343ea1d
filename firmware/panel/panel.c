#include "firmware/panel/panel.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "firmware/panel/panel_file.h"

#define MINUTE_NS INT64_C(60000000000)

struct iso_panel {
    struct iso_panel_options options;
    char *path, *port_path;
    const struct iso_seal_key *key; /* in the ring; never dropped while the panel is open */
    uint32_t key_number;
    struct iso_osdp_port *port;
    struct iso_fault fault;           /* why the file could not be used at the start */
    struct iso_fault absent;          /* why the line could not be opened at the start */
    struct iso_osdp_port_status told; /* what iso_panel_next has told */
    int64_t minute_ns;                /* the beginning of the minute */
    int news;                         /* told in this minute */
    bool held_back;                   /* there may be more, which the minute has no room for */
};

/* ---- the file ---- */

/* Called by the thread of the port. */
static int store(void *context, const struct iso_osdp_saved *saved)
{
    const struct iso_panel *panel = context;
    struct iso_panel_file file = {
        .saved = *saved,
        .configured_address = panel->options.address,
        .configured_baud = panel->options.baud,
    };
    const int error = iso_panel_file_save(panel->path, panel->key, panel->key_number, &file, NULL);
    explicit_bzero(&file, sizeof file);
    return error;
}

static int find_key(struct iso_panel *panel, struct iso_fault *fault)
{
    struct iso_key_ring *ring = panel->options.ring;
    panel->key_number = iso_key_ring_newest(ring, ISO_KEY_PANEL);
    if (panel->key_number == 0) {
        const int error = iso_key_ring_add(ring, ISO_KEY_PANEL, &panel->key_number, fault);
        if (error) {
            return error;
        }
    }
    panel->key = iso_key_ring_find(ring, ISO_KEY_PANEL, panel->key_number);
    return 0;
}

/* Reads what the panel has set. */
static void load(struct iso_panel *panel, struct iso_osdp_saved *saved)
{
    const struct iso_panel_options *options = &panel->options;
    struct iso_panel_file file;
    memset(&file, 0, sizeof file);
    *saved = (struct iso_osdp_saved){.address = options->address, .baud = options->baud};
    if (iso_panel_file_load(panel->path, options->ring, &file, &panel->fault) == 0) {
        *saved = file.saved;
        if (file.configured_address != options->address || file.configured_baud != options->baud) {
            saved->address = options->address;
            saved->baud = options->baud;
        }
    }
    explicit_bzero(&file, sizeof file);
}

/* ---- opening ---- */

/* A number that tells this appliance from others. It must not tell anything of the key. */
static uint32_t serial_of(const struct iso_panel *panel)
{
    uint8_t digest[ISO_SEAL_DIGEST_BYTES];
    const struct iso_seal_label label = iso_seal_label_of("isotherm panel serial");
    iso_seal_digest(panel->key, &label, "", 0, digest);
    return iso_get_u32(digest);
}

static void set_version(uint8_t version[3])
{
    unsigned major = 0, minor = 0, build = 0;
    (void)sscanf(ISOTHERM_VERSION, "%3u.%3u.%3u", &major, &minor, &build);
    version[0] = (uint8_t)major;
    version[1] = (uint8_t)minor;
    version[2] = (uint8_t)build;
}

static int open_port(struct iso_panel *panel, struct iso_fault *fault)
{
    const struct iso_panel_options *options = &panel->options;
    /* The vendor code is an OUI of the IEEE; the project has none. */
    struct iso_osdp_setup setup = {
        .plain = options->plain,
        .model = 1,
        .version = 1,
        .serial = serial_of(panel),
        .inputs = 1,
        .store = store,
        .context = panel,
    };
    set_version(setup.firmware);
    load(panel, &setup.saved);
    const int error = iso_osdp_port_new(options->port, &setup, &options->clock, &panel->port,
                                        &panel->absent, fault);
    explicit_bzero(&setup, sizeof setup);
    return error;
}

int iso_panel_open(const struct iso_panel_options *options, struct iso_panel **out,
                   struct iso_fault *fault)
{
    struct iso_panel *new = calloc(1, sizeof *new);
    if (!new) {
        return iso_fault_set(fault, -ENOMEM, "panel: out of memory");
    }
    new->options = *options;
    new->path = strdup(options->path);
    new->port_path = strdup(options->port);
    int error = new->path &&new->port_path ? find_key(new, fault)
                                           : iso_fault_set(fault, -ENOMEM, "panel: out of memory");
    if (!error) {
        error = open_port(new, fault);
    }
    if (error) {
        iso_panel_close(new);
        return error;
    }
    iso_osdp_port_look(new->port, &new->told);
    *out = new;
    return 0;
}

void iso_panel_close(struct iso_panel *panel)
{
    if (panel) {
        iso_osdp_port_free(panel->port);
        free(panel->path);
        free(panel->port_path);
        free(panel);
    }
}

int iso_panel_fd(const struct iso_panel *panel)
{
    return iso_osdp_port_event_fd(panel->port);
}

const struct iso_fault *iso_panel_fault(const struct iso_panel *panel)
{
    return panel->fault.text[0] ? &panel->fault : &panel->absent;
}

/* ---- to the panel ---- */

int iso_panel_send_card(struct iso_panel *panel, const struct iso_wiegand_card *card,
                        struct iso_fault *fault)
{
    uint64_t code = 0;
    uint8_t bytes[8];
    const int bits = panel->options.card_bits;
    int error = iso_wiegand_encode(bits, card, &code);
    if (error) {
        return iso_fault_set(fault, error, "panel: the card %u %u does not fit %d bits",
                             card->facility, card->number, bits);
    }
    code <<= 64 - bits;
    for (int i = 0; i < 8; i++) {
        bytes[i] = (uint8_t)(code >> (56 - 8 * i));
    }
    error = iso_osdp_port_card(panel->port, bytes, (size_t)bits);
    explicit_bzero(bytes, sizeof bytes);
    return error ? iso_fault_set(fault, error, "panel: the card was not sent: %s",
                                 error == -ENOTCONN  ? "the panel is not connected"
                                 : error == -ENOBUFS ? "too many cards wait"
                                                     : strerror(-error))
                 : 0;
}

void iso_panel_set_door(struct iso_panel *panel, bool open, bool tamper)
{
    iso_osdp_port_set_input(panel->port, 0, open);
    iso_osdp_port_set_tamper(panel->port, tamper);
}

void iso_panel_set_reader(struct iso_panel *panel, bool works)
{
    iso_osdp_port_set_reader(panel->port, works ? 0 : 1);
}

void iso_panel_install(struct iso_panel *panel)
{
    iso_osdp_port_install(panel->port);
}

/* ---- news ---- */

static bool tell(struct iso_panel_news *news, const char *event, bool alarm)
{
    *news = (struct iso_panel_news){.event = event, .alarm = alarm};
    return true;
}

static bool tell_line(struct iso_osdp_port_status *told, const struct iso_osdp_port_status *now,
                      struct iso_panel_news *news)
{
    if (told->line_gone != now->line_gone) {
        told->line_gone = now->line_gone;
        return tell(news, now->line_gone ? "line-gone" : "line-back", now->line_gone);
    }
    if (told->device.online != now->device.online) {
        told->device.online = now->device.online;
        return tell(news, now->device.online ? "online" : "offline", !now->device.online);
    }
    return false;
}

static bool tell_channel(struct iso_osdp_status *told, const struct iso_osdp_status *now,
                         struct iso_panel_news *news)
{
    if (told->keys_set != now->keys_set) {
        told->keys_set = now->keys_set;
        return tell(news, "key-set", true);
    }
    if (told->default_key != now->default_key) {
        told->default_key = now->default_key;
        return tell(news, now->default_key ? "default-key" : "closed", now->default_key);
    }
    if (told->secure != now->secure) {
        told->secure = now->secure;
        return tell(news, now->secure ? "secure" : "closed", false);
    }
    if (told->install != now->install) {
        told->install = now->install;
        /* Its beginning is on record already: a person has asked for it. */
        return !now->install && tell(news, "install-end", false);
    }
    return false;
}

static bool tell_rest(struct iso_osdp_status *told, const struct iso_osdp_status *now,
                      struct iso_panel_news *news)
{
    if (told->address != now->address || told->baud != now->baud) {
        told->address = now->address;
        told->baud = now->baud;
        (void)tell(news, "moved", true);
        (void)snprintf(news->note, sizeof news->note, "address %u, %u baud", now->address,
                       now->baud);
        return true;
    }
    if (told->undelivered != now->undelivered) {
        (void)tell(news, "undelivered", true);
        (void)snprintf(news->note, sizeof news->note, "events: %llu",
                       (unsigned long long)(now->undelivered - told->undelivered));
        told->undelivered = now->undelivered;
        return true;
    }
    return false;
}

bool iso_panel_next(struct iso_panel *panel, int64_t now_ns, struct iso_panel_news *news)
{
    struct iso_osdp_port_status now;
    if (now_ns - panel->minute_ns >= MINUTE_NS) {
        panel->minute_ns = now_ns;
        panel->news = 0;
    }
    iso_osdp_port_look(panel->port, &now);
    panel->held_back = panel->news >= ISO_PANEL_NEWS_MOST;
    if (panel->held_back) {
        return false;
    }
    const bool more = tell_line(&panel->told, &now, news) ||
                      tell_channel(&panel->told.device, &now.device, news) ||
                      tell_rest(&panel->told.device, &now.device, news);
    panel->news += more;
    return more;
}

int64_t iso_panel_due_ns(const struct iso_panel *panel)
{
    return panel->held_back ? panel->minute_ns + MINUTE_NS : INT64_MAX;
}

/* ---- the state ---- */

static const char *state_of(const struct iso_osdp_port_status *status, bool plain)
{
    const struct iso_osdp_status *device = &status->device;
    return status->line_gone     ? "gone"
           : !device->online     ? "offline"
           : device->secure      ? "secure"
           : device->default_key ? "default-key"
           : plain               ? "plain"
                                 : "waiting";
}

static struct iso_fault fault_of(const struct iso_panel *panel,
                                 const struct iso_osdp_port_status *status)
{
    struct iso_fault fault = {.text = ""};
    if (status->line_gone) {
        (void)iso_fault_set_code(&fault, ISO_FAULT_PANEL_LINE, 0, "%.200s cannot be used",
                                 panel->port_path);
    } else if (!status->device.online) {
        (void)iso_fault_set_code(&fault, ISO_FAULT_PANEL_SILENT, 0, "the panel is silent");
    } else if (!status->device.has_key) {
        fault = panel->fault;
    }
    return fault;
}

void iso_panel_look(struct iso_panel *panel, struct iso_panel_look *look)
{
    static const char *const colors[ISO_OSDP_COLORS] = {"off",  "red",     "green", "amber",
                                                        "blue", "magenta", "cyan",  "white"};
    struct iso_osdp_port_status status;
    iso_osdp_port_look(panel->port, &status);
    *look = (struct iso_panel_look){
        .state = state_of(&status, panel->options.plain),
        .install = status.device.install,
        .has_key = status.device.has_key,
        .lamp = colors[status.device.shown.lamp],
        .shown = status.device.shown,
        .fault = fault_of(panel, &status),
        .delivered = status.device.delivered,
        .undelivered = status.device.undelivered,
    };
}
