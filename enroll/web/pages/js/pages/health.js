/* The page Health: what is wrong and what helps, figures over the last day, the certificate. */

import {N_, _, _f} from '../base/i18n.js';
import {fill, h} from '../base/dom.js';
import {dateTime, duration, number} from '../base/format.js';
import {FINDINGS, word} from '../base/words.js';
import {faultText} from '../transport/fault.js';
import {badge} from '../view/badge.js';
import {chart} from '../view/chart.js';
import {stack} from '../view/stack.js';

const AGAIN_MS = 60000;
const KINDS = {
    good: 'good',
    odd: 'odd',
    denied: 'odd',
    bad: 'bad'
};

/* Sentences of the daemon are English. */
const english = (text) => text && h('span', { lang: 'en', dir: 'ltr' }, text);

function checks(list) {
    const order = ['bad', 'denied', 'odd', 'good'];
    const rows = list.toSorted((a, b) => order.indexOf(a.state) - order.indexOf(b.state));
    const head = (text) => h('th', { scope: 'col' }, text);
    return h(
        'div', { class: 'scroll' },
        stack(
            h('table', {},
              h('thead', {}, h('tr', {}, head(_('Part')), head(_('State')), head(_('Found')), head(_('Remedy')))),
              h('tbody', {},
                rows.map(
                    (check) =>
                        h('tr', {}, h('th', { scope: 'row', lang: 'en' }, check.subject),
                          h('td', {}, badge(KINDS[check.state] ?? 'plain', word(FINDINGS, check.state))),
                          h('td', {}, english(check.found),
                            check.code && h('div', { class: 'quiet' }, h('code', {}, check.code))),
                          h('td', {}, english(check.remedy))))))));
}

function figures(history) {
    const points = (key) => history.map(
        (sample) => (
            { time: sample.time_s, value: key === 'frames_per_s' && sample.sensor_works === false ? 0 : sample[key] }));
    return [
        chart(_('Frames of the sensor per second'), points('frames_per_s'), { digits: 1 }),
        chart(_('People let in, per hour'), points('allowed'), { total: true }),
        chart(_('People refused, per hour'), points('denied'), { total: true }),
        chart(_('Frames that looked like an attack, per hour'), points('attack_frames'), { total: true })
    ];
}

function groups(fingerprint) {
    const hex = String(fingerprint ?? '').replaceAll(':', '').toUpperCase();
    return hex.match(/.{1,2}/g)?.join(':') ?? '–';
}

/* All findings in one badge. */
function summary(found) {
    if (!found.healthy) {
        return badge('bad', _('Something needs attention.'));
    }
    return (found.checks ?? []).some((check) => check.state !== 'good') ?
        badge('odd', _('It works. Please read the notices.')) :
        badge('good', _('All is well.'));
}

function machine(found, status) {
    const row = (name, value) => [h('dt', {}, name), h('dd', {}, value)];
    const certificate = found.certificate;
    return h(
        'dl', { class: 'facts' }, found.version && row(_('Version of the web server'), found.version),
        row(_('Version of the door service'), status.version ?? '–'),
        row(_('Runs since'), Number.isFinite(status['uptime-ms']) ? duration(status['uptime-ms']) : '–'),
        row(_('Sensor'), [status.sensor, status['sensor-model']].filter(Boolean).join(', ') || '–'),
        row(_('Disk'),
            status['storage-fault'] ?
                [
                    badge('bad', _('Fault')), ' ', english(status['storage-fault']), ' ',
                    h('code', {}, status['storage-fault-code'] ?? '')
                ] :
                badge('good', _('Good'))),
        row(_('Records of the log'), Number.isFinite(status['log-sequence']) ? number(status['log-sequence']) : '–'),
        certificate?.fingerprint && [
            row(_('Fingerprint of the certificate (SHA-256)'),
                h('code', { class: 'long' }, groups(certificate.fingerprint))),
            row(_('The certificate ends'), _f('{time} (in {left})', {
                    time: dateTime(certificate.ends_s * 1000),
                    left: duration(certificate.ends_s * 1000 - Date.now())
                }))
        ]);
}

function make({ api, hub }) {
    const place = h('div', {}, h('p', { class: 'quiet' }, _('Loading…')));
    let gone = false;
    const draw = async () => {
        try {
            const found = await api.health();
            if (gone) {
                return;
            }
            /* Tables that are open stay open. */
            const open = [...place.querySelectorAll('details')].map((details) => details.open);
            fill(
                place,
                h('section', { class: 'panel' }, h('h2', {}, _('Findings')), h('p', { role: 'status' }, summary(found)),
                  checks(found.checks ?? [])),
                found.history &&
                    h('section', { class: 'panel' }, h('h2', {}, _('The last day')),
                      h('div', { class: 'charts' }, figures(found.history))),
                h('section', { class: 'panel' }, h('h2', {}, _('Appliance')), machine(found, hub.status)));
            place.querySelectorAll('details').forEach((details, i) => {
                details.open = open[i] ?? false;
            });
        } catch (error) {
            if (!gone) {
                fill(place, h('p', { class: 'fault', role: 'alert' }, faultText(error)));
            }
        }
    };
    const timer = setInterval(draw, AGAIN_MS);
    const end = hub.on('connection', (up) => up && draw());
    draw();
    return {
        element: place,
        resume: draw,
        leave() {
            gone = true;
            clearInterval(timer);
            end();
        },
    };
}

export const health = {
    id: 'health',
    title: N_('Health'),
    least: 'observer',
    make
};
