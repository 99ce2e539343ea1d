// The hub of the run: a PostgreSQL of its own, isotherm-hub with its pages, and doors that are played.
import { spawn, spawnSync } from 'node:child_process';
import { chownSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { expect, expectEqual, eventually } from '../check.mjs';
import { Rig, freePort, start, stop } from '../rig.mjs';

// PostgreSQL refuses to run as root.
function asUser(program, words) {
  return process.getuid() === 0 ? ['setpriv', ['--reuid=postgres', '--regid=postgres', '--clear-groups', program, ...words]] : [program, words];
}

function postgresPrograms() {
  const versions = readdirSync('/usr/lib/postgresql').sort();
  return join('/usr/lib/postgresql', versions.at(-1), 'bin');
}

export class HubRig extends Rig {
  constructor(options) {
    super(options);
    this.database = join(this.scratch, 'database');
    this.folder = join(this.scratch, 'hub');
    this.config = join(this.scratch, 'hub.conf');
    this.conninfo = `host=${this.database} user=hub dbname=postgres`;
    this.hubPages = join(this.build, 'enroll/hub/pages/pages');
  }

  async startDatabase() {
    const programs = postgresPrograms();
    mkdirSync(this.database);
    if (process.getuid() === 0) {
      const id = (flag) => Number(spawnSync('id', [flag, 'postgres'], { encoding: 'utf8' }).stdout);
      chownSync(this.database, id('-u'), id('-g'));
    }
    const data = join(this.database, 'data');
    const made = spawnSync(...asUser(join(programs, 'initdb'), ['-D', data, '-U', 'hub', '-A', 'trust', '-E', 'UTF8', '--locale=C', '--no-sync']), { encoding: 'utf8', cwd: this.database });
    expectEqual(made.status, 0, `initdb (${made.stderr})`);
    this.postgres = start(...asUser(join(programs, 'postgres'), ['-D', data, '-k', this.database, '-c', 'listen_addresses=', '-c', 'shared_buffers=16MB']), this.log('postgres'));
    await eventually('PostgreSQL answers', () => spawnSync(join(programs, 'pg_isready'), ['-h', this.database, '-U', 'hub']).status === 0, 60000);
  }

  // Runs a command of isotherm-hub, as an administrator does at the machine.
  hub(...words) {
    return spawnSync(join(this.build, 'enroll/hub/command/isotherm-hub'), [...words, '--config', this.config], { encoding: 'utf8', timeout: 30000 });
  }

  // A bundle of RAUC in the format "verity", signed by a key that only this test knows; the doors that are played install nothing.
  makeUpdate(version, board) {
    const path = (name) => join(this.scratch, name);
    const openssl = (...words) => {
      const done = spawnSync('openssl', words, { encoding: 'utf8' });
      expectEqual(done.status, 0, `openssl ${words[0]} (${done.stderr})`);
    };
    writeFileSync(path('manifest'), `[update]\ncompatible=${board}\nversion=${version}\n[bundle]\nformat=verity\n`);
    openssl('req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:P-256', '-nodes', '-subj', '/CN=updates', '-days', '1', '-keyout', path('image-key.pem'), '-out', path('image.pem'));
    openssl('cms', '-sign', '-binary', '-nodetach', '-outform', 'DER', '-signer', path('image.pem'), '-inkey', path('image-key.pem'), '-in', path('manifest'), '-out', path('message'));
    const message = readFileSync(path('message'));
    const length = Buffer.alloc(8);
    length.writeBigUInt64BE(BigInt(message.length));
    writeFileSync(path('update.raucb'), Buffer.concat([Buffer.alloc(100000, version), message, length]));
    return path('update.raucb');
  }

  async startHub() {
    this.port = await freePort();
    this.base = `https://127.0.0.1:${this.port}`;
    writeFileSync(this.config, `[database]
conninfo = ${this.conninfo}
[hub]
name = head office
folder = ${this.folder}
host = 127.0.0.1
port = ${this.port}
listen = 127.0.0.1:${this.port}
pages = ${this.hubPages}
[broker]
hub_host = localhost
hub_port = ${await freePort()}
folder =
`);
    const made = this.hub('init');
    expectEqual(made.status, 0, `isotherm-hub init (${made.stderr})`);
    this.server = start(join(this.build, 'enroll/hub/command/isotherm-hub'), ['serve', '--config', this.config], this.log('isotherm-hub'));
    const server = this.server;
    server.ended.then((code) => { server.code = code; });
    await eventually('isotherm-hub answers', () => {
      if (server.code !== undefined) {
        throw new Error(`it has ended with ${server.code}: see isotherm-hub.log`);
      }
      return this.readCertificate();
    }, 30000);
    this.authority = readFileSync(join(this.folder, 'ca.pem'));
  }

  startDoors() {
    this.doors = spawn(join(this.build, 'tests/enroll/hub/api/play_doors'), [this.conninfo, join(this.folder, 'hub.keys')], { stdio: ['pipe', 'pipe', 'inherit'] });
    const lines = createInterface({ input: this.doors.stdout });
    const waiting = [];
    lines.on('line', (line) => waiting.shift()?.(line));
    this.play = async (command) => {
      const answer = await new Promise((resolve) => {
        waiting.push(resolve);
        this.doors.stdin.write(`${command}\n`);
      });
      expect(answer === 'ok', `the played door was expected to do "${command}": ${answer}`);
    };
  }

  async stop() {
    this.doors?.kill();
    await stop(this.server);
    await stop(this.postgres, 'SIGINT');
  }
}
