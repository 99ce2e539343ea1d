#include "enroll/hub/outlet/carry/carrier.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "enroll/hub/outlet/carry/syslog.h"
#include "enroll/hub/outlet/carry/webhook.h"

struct hub__carrier {
    const struct hub__outlet_row *row;
    const struct hub_store *store; /* for the time */
    struct hub__transfer transfer;
    struct hub__syslog syslog;
};

struct hub__delivery hub__delivery_failed(enum hub__outcome outcome, const char *format, ...)
{
    struct hub__delivery delivery = {.outcome = outcome};
    va_list list;
    va_start(list, format);
    (void)vsnprintf(delivery.why, sizeof delivery.why, format, list);
    va_end(list);
    return delivery;
}

int hub__carrier_new(const struct hub__outlet_row *row, const struct hub_store *store, int stop_fd,
                     struct hub__carrier **out, struct iso_fault *fault)
{
    struct hub__carrier *carrier = calloc(1, sizeof *carrier);
    if (!carrier) {
        return iso_fault_set(fault, -ENOMEM, "an outlet: no memory");
    }
    *carrier = (struct hub__carrier){
        .row = row, .store = store, .transfer = {.stop_fd = -1, .ca_fd = -1}, .syslog.fd = -1};
    int error = hub__address_read(row->outlet.kind, row->outlet.address, &carrier->syslog.address,
                                  fault);
    error = error ? error : hub__transfer_begin(&carrier->transfer, row->ca, stop_fd, fault);
    if (error) {
        hub__carrier_free(carrier);
        return error;
    }
    *out = carrier;
    return 0;
}

void hub__carrier_free(struct hub__carrier *carrier)
{
    if (carrier) {
        if (carrier->syslog.fd >= 0) {
            (void)close(carrier->syslog.fd);
        }
        hub__transfer_end(&carrier->transfer);
        free(carrier);
    }
}

struct hub__delivery hub__carrier_hand(struct hub__carrier *carrier, const struct hub__batch *batch)
{
    const int64_t now_s = carrier->store->now_s();
    switch (carrier->syslog.address.scheme) {
    case HUB__TLS:
    case HUB__TCP:
        return hub__syslog_stream(&carrier->syslog, &carrier->transfer, now_s, batch);
    case HUB__UDP:
    case HUB__LOCAL:
        return hub__syslog_datagrams(&carrier->syslog, now_s, batch);
    case HUB__HTTPS:
    case HUB__HTTP:
        break;
    }
    return hub__webhook_hand(&carrier->transfer, carrier->row, now_s, batch);
}
