//! TLS to a caster, with the authorities that this computer trusts.
//!
//! The name of the caster must be that of its certificate. Without it, whoever is on the way could
//! send ephemerides of their own and read the password. It is a feature of the crate, `tls`, because
//! few need it and it takes long to compile.

use std::net::TcpStream;

use anyhow::Result;

use super::Line;

/// True if this program has it.
pub(super) const IS_BUILT: bool = cfg!(feature = "tls");
/// What is said if it has not.
pub(super) const MISSING: &str = "this `rai` was built without TLS: `cargo install --locked --path rai-firmware/cli --features tls` builds it with TLS";

/// Begins TLS on a connection.
///
/// # Errors
/// The caster is not the one of this name by a certificate of a known authority, or does not speak TLS.
#[cfg(not(feature = "tls"))]
pub(super) fn secure(_: TcpStream, _: &str) -> Result<Box<dyn Line>> {
    anyhow::bail!(MISSING)
}

#[cfg(feature = "tls")]
pub(super) use built::secure;

#[cfg(feature = "tls")]
mod built {
    use std::sync::Arc;
    use std::time::Instant;

    use anyhow::{Context as _, ensure};
    use rustls::pki_types::ServerName;
    use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

    use super::super::{ANSWER, is_timeout};
    use super::{Line, Result, TcpStream};

    /// Begins TLS on a connection.
    ///
    /// # Errors
    /// The caster is not the one of this name by a certificate of a known authority, or does not speak
    /// TLS.
    pub(in super::super) fn secure(stream: TcpStream, host: &str) -> Result<Box<dyn Line>> {
        Ok(Box::new(begin(stream, host, authorities()?)?))
    }

    /// Returns the authorities that this computer trusts.
    fn authorities() -> Result<RootCertStore> {
        let mut authorities = RootCertStore::empty();
        // Some that cannot be read are those that nobody uses.
        authorities.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
        ensure!(
            !authorities.is_empty(),
            "this computer has no certificates of authorities (on Debian: apt-get install ca-certificates)"
        );
        Ok(authorities)
    }

    fn begin(
        mut stream: TcpStream,
        host: &str,
        authorities: RootCertStore,
    ) -> Result<StreamOwned<ClientConnection, TcpStream>> {
        let settings = ClientConfig::builder().with_root_certificates(authorities).with_no_client_auth();
        let name = ServerName::try_from(host.to_owned())
            .with_context(|| format!("`{host}` is no name that a certificate can have"))?;
        let mut connection = ClientConnection::new(Arc::new(settings), name).context("TLS")?;
        let start = Instant::now();
        while connection.is_handshaking() {
            match connection.complete_io(&mut stream) {
                Err(error) if is_timeout(&error) && start.elapsed() < ANSWER => {}
                done => drop(done.context("TLS")?),
            }
        }
        Ok(StreamOwned::new(connection, stream))
    }

    #[cfg(all(test, unix))]
    mod tests {
        use std::io::Write as _;
        use std::net::{SocketAddr, TcpListener};
        use std::path::Path;
        use std::process::{Child, Command, Stdio};
        use std::time::Duration;

        use rustls::pki_types::CertificateDer;
        use rustls::pki_types::pem::PemObject as _;

        use super::*;

        /// Certificates of an authority of this test, and of its caster, `localhost`.
        const CERTIFICATES: &str = "set -e
openssl req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.pem -days 2 -subj '/CN=Test authority'
openssl req -newkey rsa:2048 -nodes -keyout own.key -out own.csr -subj '/CN=localhost'
echo 'subjectAltName=DNS:localhost' > names
openssl x509 -req -in own.csr -CA ca.pem -CAkey ca.key -CAcreateserial -days 2 -extfile names -out own.pem";

        /// A server of OpenSSL, killed when dropped.
        struct Server(Child, SocketAddr);

        impl Drop for Server {
            fn drop(&mut self) {
                let _ = self.0.kill();
                let _ = self.0.wait();
            }
        }

        impl Server {
            fn start(folder: &Path) -> Self {
                let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
                let mut server = Command::new("openssl");
                server.args(["s_server", "-quiet", "-accept", &address.to_string()]);
                server.args(["-cert", "own.pem", "-key", "own.key"]).current_dir(folder);
                server.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
                Self(server.spawn().unwrap(), address)
            }

            fn connect(&self) -> TcpStream {
                let start = Instant::now();
                loop {
                    if let Ok(stream) = TcpStream::connect(self.1) {
                        stream.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
                        return stream;
                    }
                    assert!(start.elapsed() < Duration::from_secs(10), "openssl does not listen");
                    std::thread::sleep(Duration::from_millis(20));
                }
            }
        }

        #[test]
        fn caster_of_another_name_or_authority_is_refused() {
            let folder = tempfile::tempdir().unwrap();
            let made = Command::new("sh").args(["-c", CERTIFICATES]).current_dir(folder.path()).output();
            if !made.is_ok_and(|output| output.status.success()) {
                println!("skipped: openssl is not installed");
                return;
            }
            let own = || {
                let mut authorities = RootCertStore::empty();
                let pem = folder.path().join("ca.pem");
                authorities.add(CertificateDer::from_pem_file(pem).unwrap()).unwrap();
                authorities
            };
            let mut server = Server::start(folder.path());
            let refusal = |host: &str, authorities| {
                format!("{:#}", begin(server.connect(), host, authorities).expect_err("refused"))
            };
            assert!(refusal("example.org", own()).contains("not valid for name"));
            if let Ok(others) = authorities() {
                assert!(refusal("localhost", others).contains("UnknownIssuer"));
            }
            let mut line = begin(server.connect(), "localhost", own()).unwrap();
            line.write_all(b"GET /MOUNT HTTP/1.0\r\n\r\n").unwrap();
            let reported = server.0.stdin.as_mut().unwrap();
            reported.write_all(b"ICY 200 OK\r\nrest").unwrap();
            let status = super::super::super::status_line(&mut line).unwrap();
            assert_eq!(status, "ICY 200 OK\r\n");
        }

        #[test]
        fn server_without_tls_is_refused_in_time() {
            let plain = TcpListener::bind("127.0.0.1:0").unwrap();
            let stream = TcpStream::connect(plain.local_addr().unwrap()).unwrap();
            let (mut other, _) = plain.accept().unwrap();
            other.write_all(b"ICY 200 OK\r\n\r\n").unwrap();
            let error = begin(stream, "localhost", RootCertStore::empty()).expect_err("refused");
            assert!(format!("{error:#}").contains("TLS"), "{error:#}");
        }
    }
}
