/* What outlets compute without a network: addresses, waiting times, bodies, signatures, messages.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/outlet/address.h"
#include "enroll/hub/outlet/carry/syslog_text.h"
#include "enroll/hub/outlet/carry/webhook_text.h"
#include "enroll/hub/outlet/run/backoff.h"

static const struct hub__batch_event visit = {
    .door = {.bytes = {0x01, 0x90, 0xb3, 0xf2, 0, 0, 0x40, 0, 0x80, 0, 0, 0, 0, 0, 0, 7}},
    .door_name = "Main \"gate\" [1] \\",
    .number = 17,
    .time = "2026-11-21T08:30:15.250Z",
    .event = "visit",
    .record = "{\"event\": \"visit\", \"person\": \"J\xc3\xbcrgen\"}",
};

static int read_address(enum hub_outlet_kind kind, const char *text, struct hub__address *out)
{
    struct iso_fault fault = {.text = ""};
    const int error = hub__address_read(kind, text, out, &fault);
    assert_true(error == 0 || *fault.text);
    return error;
}

static void addresses_are_read_in_their_parts(void **state)
{
    static const struct {
        enum hub_outlet_kind kind;
        const char *text, *host;
        enum hub__scheme scheme;
        uint16_t port;
    } cases[] = {
        {HUB_OUTLET_WEBHOOK, "https://example.org/in?x=1", "example.org", HUB__HTTPS, 443},
        {HUB_OUTLET_WEBHOOK, "https://[2001:db8::1]:8443/", "2001:db8::1", HUB__HTTPS, 8443},
        {HUB_OUTLET_WEBHOOK, "http://localhost:8080/x", "localhost", HUB__HTTP, 8080},
        {HUB_OUTLET_WEBHOOK, "http://127.0.0.1/", "127.0.0.1", HUB__HTTP, 80},
        {HUB_OUTLET_SYSLOG, "tls://logs.example.org", "logs.example.org", HUB__TLS, 6514},
        {HUB_OUTLET_SYSLOG, "tcp://10.0.0.1", "10.0.0.1", HUB__TCP, 601},
        {HUB_OUTLET_SYSLOG, "udp://[::1]:5514", "::1", HUB__UDP, 5514},
        {HUB_OUTLET_SYSLOG, "local:/dev/log", "", HUB__LOCAL, 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct hub__address address;
        assert_int_equal(read_address(cases[i].kind, cases[i].text, &address), 0);
        assert_int_equal(address.scheme, cases[i].scheme);
        assert_string_equal(address.host, cases[i].host);
        assert_int_equal(address.port, cases[i].port);
    }
}

static void addresses_that_are_not_safe_are_refused(void **state)
{
    static const struct {
        enum hub_outlet_kind kind;
        const char *text;
    } cases[] = {
        {HUB_OUTLET_WEBHOOK, "http://example.org/"}, /* events in plain text */
        {HUB_OUTLET_WEBHOOK, "http://localhost.example.org/"},
        {HUB_OUTLET_WEBHOOK, "http://localhost@example.org/"},
        {HUB_OUTLET_WEBHOOK, "https://anna:secret@example.org/"},
        {HUB_OUTLET_WEBHOOK, "https://example.org/#part"},
        {HUB_OUTLET_WEBHOOK, "ftp://example.org/"},
        {HUB_OUTLET_WEBHOOK, "file:///etc/passwd"},
        {HUB_OUTLET_WEBHOOK, "tls://example.org"},
        {HUB_OUTLET_WEBHOOK, "example.org"},
        {HUB_OUTLET_WEBHOOK, ""},
        {HUB_OUTLET_SYSLOG, "https://example.org/"},
        {HUB_OUTLET_SYSLOG, "tcp://example.org/path"},
        {HUB_OUTLET_SYSLOG, "tcp://example.org:70000"},
        {HUB_OUTLET_SYSLOG, "local:dev/log"},
        {HUB_OUTLET_SYSLOG, "local:"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct hub__address address;
        if (read_address(cases[i].kind, cases[i].text, &address) != -EINVAL) {
            fail_msg("'%s' was accepted", cases[i].text);
        }
    }
}

static void waiting_doubles_between_its_bounds(void **state)
{
    int64_t most = HUB__BACKOFF_FIRST_MS;
    (void)state;
    for (uint64_t failures = 1; failures < 80; failures++) {
        for (uint32_t random = 0; random < 5000; random += 7) {
            const int64_t wait = hub__backoff_ms(failures, 0, random * 1000003U);
            assert_in_range(wait, most / 2, most);
        }
        most = 2 * most < HUB__BACKOFF_MOST_MS ? 2 * most : HUB__BACKOFF_MOST_MS;
    }
    assert_int_equal(most, HUB__BACKOFF_MOST_MS);
    assert_int_equal(hub__backoff_ms(UINT64_MAX, 0, 0), HUB__BACKOFF_MOST_MS / 2);
    /* The receiver may ask for more, not for less, and not for ever. */
    assert_int_equal(hub__backoff_ms(1, 90, 0), 90000);
    assert_int_equal(hub__backoff_ms(20, 1, 0), HUB__BACKOFF_MOST_MS / 2);
    assert_int_equal(hub__backoff_ms(1, INT64_MAX, 0), 3600000);
}

static void lines_become_rare_and_never_end(void **state)
{
    int lines = 0;
    (void)state;
    for (uint64_t failures = 1; failures <= 1024; failures++) {
        lines += hub__backoff_says(failures);
    }
    assert_int_equal(lines, 11);
    assert_true(hub__backoff_says(1));
    assert_true(hub__backoff_says(1ULL << 40));
}

static void the_body_has_the_record_as_the_door_wrote_it(void **state)
{
    const struct hub__batch batch = {.n = 1, .one = &visit};
    char *body = hub__webhook_body(&batch);
    (void)state;
    assert_non_null(body);
    json_t *array = json_loads(body, 0, NULL);
    assert_int_equal(json_array_size(array), 1);
    json_t *event = json_array_get(array, 0);
    assert_string_equal(json_string_value(json_object_get(event, "door")),
                        "0190b3f2-0000-4000-8000-000000000007");
    assert_string_equal(json_string_value(json_object_get(event, "door_name")), visit.door_name);
    assert_int_equal(json_integer_value(json_object_get(event, "number")), 17);
    assert_string_equal(json_string_value(json_object_get(event, "time")), visit.time);
    assert_string_equal(
        json_string_value(json_object_get(json_object_get(event, "record"), "person")),
        "J\xc3\xbcrgen");
    json_decref(array);
    free(body);
}

/* Computed by: printf '1795251015.[]' | openssl dgst -sha256 -hmac 0123456789abcdef */
static void the_signature_is_that_of_another_program(void **state)
{
    char text[HUB__SIGNATURE_SIZE];
    (void)state;
    hub__webhook_sign("0123456789abcdef", 1795251015, "[]", text);
    assert_string_equal(text, "t=1795251015,v1="
                              "1e2941da333c29abfb0aece8c55e0baf61b387de62ae8828a9a888bcc1041dd6");
}

static void a_message_has_the_form_of_rfc_5424(void **state)
{
    char *text = hub__syslog_text(&visit, HUB__SYSLOG_NETWORK, 0);
    (void)state;
    assert_string_equal(text,
                        "<86>1 2026-11-21T08:30:15.250Z Main-\"gate\"-[1]-\\ isotherm - visit "
                        "[isotherm@32473 door=\"0190b3f2-0000-4000-8000-000000000007\" "
                        "name=\"Main \\\"gate\\\" [1\\] \\\\\" number=\"17\" event=\"visit\"] "
                        "{\"event\":\"visit\",\"person\":\"J\\u00FCrgen\"}");
    free(text);
}

static void a_message_of_an_event_without_time_has_nil_values(void **state)
{
    const struct hub__batch_event event = {
        .door_name = "T\xc3\xbcr", .time = "", .event = "duress", .record = "{}"};
    char *text = hub__syslog_text(&event, HUB__SYSLOG_NETWORK, 0);
    (void)state;
    assert_string_equal(text, "<81>1 - T--r isotherm - duress [isotherm@32473 "
                              "door=\"00000000-0000-0000-0000-000000000000\" "
                              "name=\"T\xc3\xbcr\" number=\"0\" event=\"duress\"] {}");
    free(text);
}

static void a_local_message_has_the_form_of_local_programs(void **state)
{
    char *text;
    (void)state;
    assert_int_equal(setenv("TZ", "UTC-1", 1), 0);
    tzset();
    text = hub__syslog_text(&visit, HUB__SYSLOG_LOCAL, 0);
    assert_ptr_equal(strstr(text, "<86>Nov 21 09:30:15 isotherm-hub: [isotherm@32473 door="), text);
    free(text);
    const struct hub__batch_event event = {
        .door_name = "", .time = "", .event = "lockout", .record = "{}"};
    text = hub__syslog_text(&event, HUB__SYSLOG_LOCAL, 86400);
    assert_ptr_equal(strstr(text, "<84>Jan  2 01:00:00 isotherm-hub: "), text);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(addresses_are_read_in_their_parts),
        cmocka_unit_test(addresses_that_are_not_safe_are_refused),
        cmocka_unit_test(waiting_doubles_between_its_bounds),
        cmocka_unit_test(lines_become_rare_and_never_end),
        cmocka_unit_test(the_body_has_the_record_as_the_door_wrote_it),
        cmocka_unit_test(the_signature_is_that_of_another_program),
        cmocka_unit_test(a_message_has_the_form_of_rfc_5424),
        cmocka_unit_test(a_message_of_an_event_without_time_has_nil_values),
        cmocka_unit_test(a_local_message_has_the_form_of_local_programs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
