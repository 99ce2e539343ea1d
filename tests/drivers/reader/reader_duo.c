#include "tests/drivers/reader/reader_duo.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

const uint8_t duo_key[16] = {1, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 121, 98, 219};

static uint32_t throw_dice(struct duo *duo, uint32_t sides)
{
    duo->dice = duo->dice * 1664525 + 1013904223;
    return (duo->dice >> 8) % sides;
}

static int make_random(void *context, void *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        ((uint8_t *)bytes)[i] = (uint8_t)throw_dice(context, 256);
    }
    return 0;
}

static int store(void *context, const struct iso_osdp_saved *saved)
{
    (void)context;
    (void)saved;
    return 0;
}

void duo_plug_device(struct duo *duo, bool has_key, bool plain)
{
    struct iso_osdp_setup setup = {
        .saved = {.address = 5, .baud = 9600, .has_key = has_key},
        .plain = plain,
        .serial = 4711,
        .random = make_random,
        .store = store,
        .context = duo,
    };
    memcpy(setup.saved.key, duo_key, has_key ? sizeof duo_key : 0);
    iso_osdp_peripheral_free(duo->device);
    assert_int_equal(iso_osdp_peripheral_new(&setup, &duo->device), 0);
}

struct iso_osdp_reader_setup duo_reader_setup(struct duo *duo, bool has_key)
{
    struct iso_osdp_reader_setup setup = {
        .address = 5, .baud = 9600, .has_key = has_key, .random = make_random, .context = duo};
    memcpy(setup.key, duo_key, has_key ? sizeof duo_key : 0);
    return setup;
}

void duo_open_reader(struct duo *duo, bool has_key)
{
    const struct iso_osdp_reader_setup setup = duo_reader_setup(duo, has_key);
    iso_osdp_reader_free(duo->reader);
    assert_int_equal(iso_osdp_reader_new(&setup, duo->now_ns, &duo->reader), 0);
}

void duo_open(struct duo *duo, bool has_key)
{
    *duo = (struct duo){.now_ns = 1000 * MS, .dice = 12345};
    duo_plug_device(duo, has_key, !has_key);
    duo_open_reader(duo, has_key);
}

void duo_close(struct duo *duo)
{
    iso_osdp_reader_free(duo->reader);
    iso_osdp_peripheral_free(duo->device);
}

/* What the wire does to n bytes. Returns how many arrive. */
static size_t pass(struct duo *duo, uint8_t *bytes, size_t n)
{
    if (duo->unplugged) {
        return 0;
    }
    if (n == 0 || duo->loss == 0 || throw_dice(duo, duo->loss) > 0) {
        return n;
    }
    switch (throw_dice(duo, 3)) {
    case 0:
        bytes[throw_dice(duo, (uint32_t)n)] ^= (uint8_t)(1 + throw_dice(duo, 255));
        return n;
    case 1:
        return throw_dice(duo, (uint32_t)n);
    default:
        return 0;
    }
}

void duo_exchange(struct duo *duo)
{
    uint8_t frame[ISO_OSDP_FRAME_BYTES];
    duo->now_ns = iso_osdp_reader_due_ns(duo->reader);
    size_t n = iso_osdp_reader_send(duo->reader, duo->now_ns, frame);
    n = pass(duo, frame, n);
    duo->now_ns += 5 * MS;
    duo->n_reply = iso_osdp_peripheral_receive(duo->device, frame, n, duo->now_ns, duo->reply);
    (void)iso_osdp_peripheral_sent(duo->device);
    duo->now_ns += 5 * MS;
    const size_t arrived = pass(duo, duo->reply, duo->n_reply);
    iso_osdp_reader_receive(duo->reader, duo->reply, arrived, duo->now_ns);
}

struct iso_osdp_reader_status duo_status(const struct duo *duo)
{
    struct iso_osdp_reader_status status;
    iso_osdp_reader_status(duo->reader, &status);
    return status;
}

void duo_run_until_online(struct duo *duo)
{
    for (int i = 0; i < 100 && !duo_status(duo).online; i++) {
        duo_exchange(duo);
    }
    assert_true(duo_status(duo).online);
    duo_exchange(duo);
    duo_exchange(duo);
}

void duo_run_for(struct duo *duo, int64_t ns)
{
    for (const int64_t end_ns = duo->now_ns + ns; duo->now_ns < end_ns;) {
        duo_exchange(duo);
    }
}

int duo_add(struct duo *duo, unsigned i)
{
    const uint8_t card[5] = {0xAB, 0, 0, (uint8_t)(i >> 8), (uint8_t)i};
    const char digit[2] = {"0123456789*#"[i % 12], '\0'};
    return i % 3 == 2 ? iso_osdp_peripheral_digits(duo->device, digit)
                      : iso_osdp_peripheral_card(duo->device, card, 40);
}

void duo_expect(const struct iso_reader_event *event, unsigned i)
{
    if (i % 3 == 2) {
        assert_int_equal(event->kind, ISO_READER_KEY);
        assert_int_equal(event->key, "0123456789*#"[i % 12]);
    } else {
        assert_int_equal(event->kind, ISO_READER_CARD);
        assert_int_equal(event->bits, 40);
        assert_int_equal(event->code, UINT64_C(0xAB00000000) + i);
    }
}
