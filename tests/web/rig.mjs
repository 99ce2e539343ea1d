// The appliance of the run: a bus, isothermd on stored frames, and isotherm-web, all in one scratch folder.
import { spawn, spawnSync } from 'node:child_process';
import { createHash, X509Certificate } from 'node:crypto';
import { chmodSync, createWriteStream, existsSync, mkdirSync, readFileSync, renameSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:net';
import { join } from 'node:path';
import { connect } from 'node:tls';
import { expect, eventually } from './check.mjs';

const running = new Set();
process.on('exit', () => running.forEach((child) => child.kill('SIGKILL')));
for (const signal of ['SIGINT', 'SIGTERM']) {
  process.on(signal, () => process.exit(130));
}

// A child that writes its output to a file. `child.ended` is resolved with its exit code.
export function start(program, words, log, environment = {}) {
  const out = createWriteStream(log, { flags: 'a' });
  const child = spawn(program, words, { env: { ...process.env, ...environment }, stdio: ['ignore', 'pipe', 'pipe'] });
  running.add(child);
  child.stdout.pipe(out);
  child.stderr.pipe(out);
  child.ended = new Promise((resolve) => {
    child.on('error', (fault) => resolve(fault.message));
    child.on('exit', (code, signal) => {
      running.delete(child);
      resolve(signal ?? code);
    });
  });
  return child;
}

export async function stop(child, signal = 'SIGTERM') {
  if (child) {
    child.kill(signal);
    return child.ended;
  }
  return 0;
}

export function freePort() {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.on('error', reject);
    server.listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

export class Rig {
  // source: the project; build: its build; scratch: an empty folder; out: where the logs go
  constructor({ source, build, scratch, out }) {
    Object.assign(this, { source, build, scratch, out });
    this.slot = join(scratch, 'slot');
    this.address = `unix:path=${join(scratch, 'bus')}`;
    this.stored = join(source, 'sim/stored');
    this.gallery = join(scratch, 'daemon');
    this.groups = { 'isotherm-observe': 'games', 'isotherm-identify': 'audio', 'isotherm-enroll': 'video', isotherm: 'floppy' };
    this.cockpitBrowsers = [];
    mkdirSync(this.gallery);
    chmodSync(scratch, 0o711); // other users reach the bus
    // A build may put the pages together with their catalogues.
    const built = join(build, 'enroll/web/pages/pages');
    this.pages = existsSync(join(built, 'index.html')) ? built : join(source, 'enroll/web/pages');
  }

  log(name) {
    return join(this.out, `${name}.log`);
  }

  // The project's own policy, with groups of Debian in the place of its own. It lets root own the name. For other users the bus allows
  // everything.
  async startBus() {
    let policy = readFileSync(join(this.source, 'board/generic/org.isotherm.Isotherm.conf'), 'utf8');
    for (const [group, present] of Object.entries(this.groups)) {
      policy = policy.replace(`group="${group}"`, `group="${present}"`);
    }
    writeFileSync(join(this.scratch, 'policy.conf'), policy);
    const include = process.getuid() === 0 ? `<include>${join(this.scratch, 'policy.conf')}</include>` : '';
    writeFileSync(join(this.scratch, 'bus.conf'), `<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>isotherm-web-check</type><listen>${this.address}</listen><auth>EXTERNAL</auth>
<policy context="default"><allow send_destination="*"/><allow receive_sender="*"/><allow own="*"/><allow user="*"/></policy>
${include}</busconfig>
`);
    this.bus = start('dbus-daemon', [`--config-file=${join(this.scratch, 'bus.conf')}`, '--nofork', '--nopidfile'], this.log('dbus-daemon'));
    await eventually('a bus that listens', () => existsSync(join(this.scratch, 'bus')));
  }

  // The times are short, and those of the camera long: the machine may be busy. Scores and counts are those of the product.
  // The camera plays its recording again and again, so that there are always frames.
  configure({ capacity = 1000 } = {}) {
    writeFileSync(join(this.scratch, 'isotherm.conf'), `[sensor]
backend = replay
path = ${this.slot}
loop = yes
repeats = yes
retry_ms = 50
retry_max_ms = 100
stale_ms = 5000
pause_ms = 5000
[motion]
frozen_frames = 0
[door]
backend = null
unlock_ms = 1500
[decision]
gap_ms = 300
[hint]
hold_frames = 2
[lockout]
failures = 0
attacks = 0
[enroll]
timeout_ms = 90000
[gallery]
path = ${join(this.gallery, 'gallery.db')}
capacity = ${capacity}
[log]
path = ${join(this.gallery, 'audit.log')}
sync = no
[bus]
address = ${this.address}
[model]
head = ${join(this.source, 'core/data/head.model')}
metric = ${join(this.source, 'core/data/face.metric')}
`);
  }

  async startDaemon() {
    this.daemon = start(join(this.build, 'firmware/isothermd'), ['--config', join(this.scratch, 'isotherm.conf')], this.log('isothermd'));
    const daemon = this.daemon;
    daemon.ended.then((code) => { daemon.code = code; });
    await eventually('isothermd answers', () => {
      if (daemon.code !== undefined) {
        throw new Error(`it has ended with ${daemon.code}: see isothermd.log`);
      }
      return this.isotherm('status').status === 0;
    }, 60000);
  }

  async stopDaemon(signal = 'SIGTERM') {
    await stop(this.daemon, signal);
    this.daemon = undefined;
  }

  // Starts the daemon anew with another state, in which `people` people are enrolled.
  async startCrowd(people) {
    await this.stopDaemon();
    this.gallery = join(this.scratch, 'crowd');
    mkdirSync(this.gallery);
    const filled = spawnSync(join(this.build, 'tests/bench/bench_gallery'),
      ['--dir', this.gallery, '--people', String(people), '--keep', '1', '--metric', join(this.source, 'core/data/face.metric')], { encoding: 'utf8' });
    expect(filled.status === 0, `bench_gallery was expected to enrol ${people} people: ${filled.stderr}`);
    this.configure({ capacity: people + 1000 });
    this.show();
    await this.startDaemon();
  }

  // Runs the command line tool.
  isotherm(...words) {
    return spawnSync(join(this.build, 'enroll/isotherm'), ['--bus', this.address, ...words], { encoding: 'utf8', timeout: 20000 });
  }

  // Puts a recording before the camera; without a name nobody is there: the camera sees an empty room.
  show(recording = 'none-nobody1') {
    const next = `${this.slot}.next`;
    rmSync(next, { force: true });
    const target = join(this.stored, recording);
    expect(existsSync(target), `the recording ${target} is missing`);
    symlinkSync(target, next);
    renameSync(next, this.slot);
  }

  // Runs isotherm-web with further words, as an administrator does at the machine.
  web(...words) {
    return spawnSync(join(this.build, 'enroll/web/isotherm-web'), this.webWords(words), { encoding: 'utf8', timeout: 20000 });
  }

  webWords(words) {
    return ['--state', join(this.scratch, 'web'), ...words];
  }

  async startWeb() {
    mkdirSync(join(this.scratch, 'web'), { recursive: true, mode: 0o700 });
    this.port ??= await freePort();
    this.base = `https://127.0.0.1:${this.port}`;
    this.server = start(join(this.build, 'enroll/web/isotherm-web'),
      this.webWords(['--bus', this.address, '--listen', `127.0.0.1:${this.port}`, '--pages', this.pages,
        '--updates', join(this.scratch, 'root/var/lib/isotherm-update')]), this.log('isotherm-web'));
    const server = this.server;
    server.ended.then((code) => { server.code = code; });
    await eventually('isotherm-web answers', () => {
      if (server.code !== undefined) {
        throw new Error(`it has ended with ${server.code}: see isotherm-web.log`);
      }
      return this.readCertificate();
    }, 20000);
  }

  async stopWeb() {
    const code = await stop(this.server);
    this.server = undefined;
    return code;
  }

  // Fetches the server's certificate, as a browser sees it.
  readCertificate() {
    return new Promise((resolve, reject) => {
      const socket = connect({ host: '127.0.0.1', port: this.port, rejectUnauthorized: false }, () => {
        const raw = socket.getPeerCertificate().raw;
        socket.destroy();
        this.certificate = new X509Certificate(raw);
        resolve(this.certificate);
      });
      socket.on('error', reject);
    });
  }

  // The base64 of the SHA-256 of the public key, as Chromium wants it.
  keyHash() {
    return createHash('sha256').update(this.certificate.publicKey.export({ type: 'spki', format: 'der' })).digest('base64');
  }

  // Kilobytes of memory of the web server: {rss, pss}.
  memory() {
    const text = readFileSync(`/proc/${this.server.pid}/smaps_rollup`, 'utf8');
    const of = (key) => Number(new RegExp(`^${key}: *(\\d+) kB`, 'm').exec(text)[1]);
    return { rss: of('Rss'), pss: of('Pss'), anonymous: of('Anonymous') };
  }

  async stop() {
    await stop(this.server);
    await stop(this.daemon);
    await stop(this.bus);
  }
}
