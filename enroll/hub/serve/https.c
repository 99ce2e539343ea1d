/* The hub's HTTPS: the certificate, the server, and that both are renewed. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "enroll/hub/serve/service.h"
#include "enroll/web/listener.h"

enum { RENEW_US = 3600 * 1000000U };

static const struct web_plain_route plain[] = {
    {.path = "/fleet/v1/join", .type = "application/json", .handle = hub__post_join},
    {.path = "/fleet/v1/renew", .type = "application/json", .handle = hub__post_renew},
    {.path = "/fleet/v1/fetch", .type = "application/octet-stream", .handle = hub__post_fetch},
    {.path = "/scim/v2/",
     .handle = hub__scim,
     .methods = "GET, POST, PUT, PATCH, DELETE",
     .body_most = HUB_SCIM_BODY_MOST},
    {.path = "/metrics", .handle = hub__get_metrics, .methods = "GET"},
    {.path = NULL},
};

static int start_server(struct hub_service *service, struct iso_fault *fault)
{
    struct web_server_setup setup = {.event = service->event,
                                     .certificate = &service->certificate,
                                     .sessions = &service->sessions,
                                     .pages = hub__administration_pages(service),
                                     .routes = hub_api_routes,
                                     .plain = plain,
                                     .context = service};

    setup.listen_fd = fcntl(service->listen_fd, F_DUPFD_CLOEXEC, 3);
    if (setup.listen_fd < 0) {
        return iso_fault_set(fault, -errno, "the socket of HTTPS: %s", strerror(errno));
    }
    const int r = web_server_new(&setup, &service->server, fault);
    service->api.login.server = r < 0 ? NULL : service->server;
    return r;
}

/* Opens the certificate, which is made anew when that is due. *is_new: it is another one than
 * before. */
static int open_certificate(struct hub_service *service, bool *is_new, struct iso_fault *fault)
{
    const struct hub_serve_options *options = service->options;
    struct hub_pair pair;
    const int r = hub_pair_open(service->ca, options->folder, HUB_PAIR_HTTPS, options->hosts,
                                options->n_hosts, service->store.now_s(), &pair, fault);

    if (r < 0) {
        return r;
    }
    /* Another process of the hub may have made it. */
    *is_new = !service->certificate.chain || strcmp(service->certificate.chain, pair.chain) != 0;
    if (*is_new) {
        web_certificate_free(&service->certificate);
        service->certificate = (struct web_certificate){
            .key = pair.key, .chain = pair.chain, .ends_s = pair.ends_s};
        pair.key = pair.chain = NULL;
    }
    hub_pair_free(&pair);
    return 0;
}

/* The connection to the broker takes its certificate anew when it is made again. */
static int renew_client(struct hub_service *service, struct iso_fault *fault)
{
    struct hub_pair pair;
    const int r = service->options->broker_plain
                      ? 0
                      : hub_pair_open(service->ca, service->options->folder, HUB_PAIR_CLIENT, NULL,
                                      0, service->store.now_s(), &pair, fault);

    if (r == 0 && !service->options->broker_plain) {
        hub_pair_free(&pair);
    }
    return r;
}

int hub__https_renew(struct hub_service *service, struct iso_fault *fault)
{
    bool is_new = false;
    int r = renew_client(service, fault);

    r = r < 0 ? r : open_certificate(service, &is_new, fault);
    if (r == 0 && is_new && service->server) {
        /* Answers that are being sent are cut off, some times in the life of a hub. */
        web_server_free(service->server);
        service->server = service->api.login.server = NULL;
        r = start_server(service, fault);
    }
    return r;
}

static int on_hour(sd_event_source *source, uint64_t usec, void *context)
{
    struct hub_service *service = context;
    struct iso_fault fault = {.text = ""};

    (void)usec;
    if (hub__https_renew(service, &fault)) {
        fprintf(stderr, SD_ERR "isotherm-hub: certificates: %s\n", fault.text);
    }
    return sd_event_source_set_time_relative(source, RENEW_US);
}

int hub__https_start(struct hub_service *service, struct iso_fault *fault)
{
    int r = web_listener_open(service->options->listen, &service->listen_fd, fault);

    if (r < 0) {
        return r;
    }
    service->joins = hub_bucket_of(20, 2);
    service->renewals = hub_bucket_of(100, 20);
    r = hub__https_renew(service, fault);
    r = r < 0 ? r : start_server(service, fault);
    if (r == 0) {
        r = sd_event_add_time_relative(service->event, &service->hourly, CLOCK_MONOTONIC, RENEW_US,
                                       1000000, on_hour, service);
        r = r < 0 ? r : sd_event_source_set_enabled(service->hourly, SD_EVENT_ON);
        r = r < 0 ? iso_fault_set(fault, r, "the event loop: %s", strerror(-r)) : 0;
    }
    return r;
}

void hub__https_stop(struct hub_service *service)
{
    service->hourly = sd_event_source_disable_unref(service->hourly);
    web_server_free(service->server);
    service->server = service->api.login.server = NULL;
    web_certificate_free(&service->certificate);
    if (service->listen_fd >= 0) {
        (void)close(service->listen_fd);
        service->listen_fd = -1;
    }
}
