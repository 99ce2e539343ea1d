/* The log of the script. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

enum { RECORD_SIZE = 512 };
enum { LOG_RECORDS_MAX = 100 }; /* at most per answer: less than a client may ask for */

/* Successive records are ten minutes apart. Every fifth record is about the door, the others are
 * about visits. */
static void write_record(const struct fake_script *script, uint64_t i, char line[RECORD_SIZE])
{
    const time_t time_s = 1795249215 + (time_t)i * 600; /* record 1: 2026-11-21T08:30:15Z */
    char time[32];
    struct tm utc;

    (void)strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%S", gmtime_r(&time_s, &utc));
    (void)snprintf(line, RECORD_SIZE,
                   "{\"sequence\": %" PRIu64 ", \"time\": \"%s.042Z\", \"monotonic_ns\": 1234567, ",
                   i, time);
    const size_t length = strlen(line);
    if (script->last_record && i == script->n_records) {
        (void)snprintf(line + length, RECORD_SIZE - length, "%s}", script->last_record);
    } else if (i % 5 == 0) {
        (void)snprintf(line + length, RECORD_SIZE - length,
                       "\"event\": \"door\", \"note\": \"locked, by \\\"time\\\"\"}");
    } else {
        (void)snprintf(line + length, RECORD_SIZE - length,
                       "\"event\": \"visit\", \"person\": \"%s\", \"verdict\": \"%s\", \"score\": "
                       "2.345678, \"frames\": 3, \"novelty\": true}",
                       i % 2 ? "anna" : "Bo Ek", i % 2 ? "allow" : "deny");
    }
}

int fake_on_read_log(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct fake_service *service = context;
    const struct fake_script *script = service->script;
    sd_bus_message *reply = NULL;
    uint64_t from;
    uint32_t max;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    if (service->n_refused < script->refused) {
        service->n_refused++;
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_TOO_MANY_CALLS, "the fake says so");
    }
    const uint64_t n = ++service->n_log_calls;
    const uint64_t first = 1 + n * script->records_go;
    const uint64_t last = script->n_records + n * script->records_come;
    int r = sd_bus_message_read(call, "tu", &from, &max);
    from = from < first ? first : from;
    max = max < LOG_RECORDS_MAX ? max : LOG_RECORDS_MAX;
    if (r >= 0) {
        r = sd_bus_message_new_method_return(call, &reply);
    }
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "s");
    }
    for (uint64_t i = from; r >= 0 && i <= last && i - from < max; i++) {
        char line[RECORD_SIZE];
        write_record(script, i, line);
        r = sd_bus_message_append_basic(reply, 's', line);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(reply);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}
