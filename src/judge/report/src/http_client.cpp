// SPDX-License-Identifier: Apache-2.0
#include "http_client.h"

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <optional>

#if TROCAR_HAS_OPENSSL
#include <boost/asio/ssl/host_name_verification.hpp>
#include <boost/beast/ssl.hpp>
#endif

#include "trocar/host/version.h"
#include "trocar/report/document.h"

namespace trocar::report {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using tcp = asio::ip::tcp;

constexpr std::size_t kMostAnswer = 1u << 20;  // [bytes]

bool IsThisMachine(const std::string& host) {
  return host == "localhost" || host == "127.0.0.1" || host == "::1";
}

base::Error Away(const Endpoint& endpoint, const std::string& what) {
  return {base::ErrorCode::kXapiAway, "the learning record store at " + endpoint.host + ":" + endpoint.port +
                                          ": " + what + "; it is tried again later"};
}

/// Runs one asynchronous call to its end; the stream's own timer ends what takes too long.
template <typename Start>
error_code Finish(asio::io_context& context, const Start& start) {
  std::optional<error_code> result;
  start([&](const error_code& error, auto&&...) { result = error; });
  context.restart();
  context.run();
  return result.value_or(asio::error::operation_aborted);
}

http::request<http::string_body> MakeRequest(const Endpoint& endpoint, const std::string& statement,
                                             const std::string& credentials) {
  http::request<http::string_body> request(http::verb::post, endpoint.path + "/statements", 11);
  const bool is_six = endpoint.host.find(':') != std::string::npos;
  request.set(http::field::host, (is_six ? "[" + endpoint.host + "]" : endpoint.host) + ":" + endpoint.port);
  request.set(http::field::user_agent, "Trocar/" + std::string(host::VersionText()));
  request.set(http::field::content_type, "application/json");
  request.set(http::field::connection, "close");
  request.set("X-Experience-API-Version", "1.0.3");
  if (!credentials.empty()) request.set(http::field::authorization, "Basic " + EncodeBase64(credentials));
  request.body() = statement;
  request.prepare_payload();
  return request;
}

/// Over a stream that is connected.
template <typename Stream>
base::Result<HttpAnswer> Exchange(asio::io_context& context, Stream& stream, const Endpoint& endpoint,
                                  const http::request<http::string_body>& request,
                                  std::chrono::duration<double> most) {
  auto& lowest = beast::get_lowest_layer(stream);
  lowest.expires_after(std::chrono::duration_cast<std::chrono::nanoseconds>(most));
  if (const auto error = Finish(context, [&](auto done) { http::async_write(stream, request, done); }); error)
    return Away(endpoint, "the request could not be sent (" + error.message() + ")");
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(kMostAnswer);
  if (const auto error = Finish(context, [&](auto done) { http::async_read(stream, buffer, parser, done); });
      error)
    return Away(endpoint, "no whole answer came (" + error.message() + ")");
  const auto& response = parser.get();
  HttpAnswer answer{static_cast<int>(response.result_int()), 0, response.body()};
  if (const auto field = response.find(http::field::retry_after); field != response.end())
    answer.retry_after = std::clamp(std::atof(std::string(field->value()).c_str()), 0.0, 3600.0);
  return answer;
}

base::Status Connect(asio::io_context& context, beast::tcp_stream& stream, const Endpoint& endpoint,
                     std::chrono::duration<double> most) {
  error_code error;
  tcp::resolver resolver(context);
  const auto found = resolver.resolve(endpoint.host, endpoint.port, error);
  if (error) return Away(endpoint, "its name is not known (" + error.message() + ")");
  if (!endpoint.is_secure) {
    for (const auto& one : found) {
      if (!one.endpoint().address().is_loopback())
        return base::Error{base::ErrorCode::kXapiUnsafe,
                           endpoint.host + " leads to another machine; use https"};
    }
  }
  stream.expires_after(std::chrono::duration_cast<std::chrono::nanoseconds>(most));
  error = Finish(context, [&](auto done) { stream.async_connect(found, done); });
  if (error) return Away(endpoint, "cannot be reached (" + error.message() + ")");
  return {};
}

#if TROCAR_HAS_OPENSSL
base::Result<HttpAnswer> PostSecurely(asio::io_context& context, const Endpoint& endpoint,
                                      const http::request<http::string_body>& request,
                                      std::chrono::duration<double> most) {
  asio::ssl::context tls(asio::ssl::context::tls_client);
  error_code error;
  tls.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                      asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                      asio::ssl::context::no_tlsv1_1,
                  error);
  tls.set_default_verify_paths(error);
  if (error)
    return base::Error{base::ErrorCode::kXapiUnsafe,
                       "the system's certificates cannot be read; install ca-certificates"};
  beast::ssl_stream<beast::tcp_stream> stream(context, tls);
  stream.set_verify_mode(asio::ssl::verify_peer);
  stream.set_verify_callback(asio::ssl::host_name_verification(endpoint.host));
  SSL_set_tlsext_host_name(stream.native_handle(), endpoint.host.c_str());
  if (auto connected = Connect(context, beast::get_lowest_layer(stream), endpoint, most); !connected.ok())
    return connected.error();
  error = Finish(context, [&](auto done) { stream.async_handshake(asio::ssl::stream_base::client, done); });
  if (SSL_get_verify_result(stream.native_handle()) != X509_V_OK ||
      error.category() == asio::error::get_ssl_category())
    return base::Error{base::ErrorCode::kXapiUnsafe,
                       endpoint.host + " could not prove who it is (" + error.message() +
                           "); check the address, or add its authority to the system's certificates"};
  if (error) return Away(endpoint, "no secure connection was made (" + error.message() + ")");
  return Exchange(context, stream, endpoint, request, most);
}
#endif

}  // namespace

base::Result<Endpoint> ParseEndpoint(const std::string& url) {
  Endpoint endpoint;
  const base::Error unusable{base::ErrorCode::kUsage,
                             "\"" + url + "\" is no address such as https://lrs.hospital.example/xapi"};
  std::string rest;
  for (const auto& [scheme, is_secure] : {std::pair{"https://", true}, std::pair{"http://", false}}) {
    if (url.rfind(scheme, 0) != 0) continue;
    endpoint.is_secure = is_secure;
    rest = url.substr(std::string(scheme).size());
  }
  const bool is_odd = std::any_of(rest.begin(), rest.end(), [](char c) {
    return static_cast<unsigned char>(c) <= ' ' || c == 0x7f || c == '@' || c == '?' || c == '#';
  });
  if (rest.empty() || is_odd) return unusable;
  const std::size_t slash = rest.find('/');
  std::string authority = rest.substr(0, slash);
  if (slash != std::string::npos) endpoint.path = rest.substr(slash);
  while (!endpoint.path.empty() && endpoint.path.back() == '/') endpoint.path.pop_back();
  const std::size_t bracket = authority.find(']');
  const std::size_t colon = authority.find(':', bracket == std::string::npos ? 0 : bracket);
  endpoint.port =
      colon == std::string::npos ? (endpoint.is_secure ? "443" : "80") : authority.substr(colon + 1);
  endpoint.host = authority.substr(0, colon);
  if (bracket != std::string::npos && authority[0] == '[') endpoint.host = authority.substr(1, bracket - 1);
  const bool is_number = !endpoint.port.empty() && endpoint.port.size() <= 5 &&
                         std::all_of(endpoint.port.begin(), endpoint.port.end(),
                                     [](unsigned char c) { return std::isdigit(c) != 0; });
  if (endpoint.host.empty() || !is_number || std::stoi(endpoint.port) < 1 || std::stoi(endpoint.port) > 65535)
    return unusable;
  if (!endpoint.is_secure && !IsThisMachine(endpoint.host))
    return base::Error{
        base::ErrorCode::kXapiUnsafe,
        "http to another machine would show results and password to everybody on the way; use https"};
#if !TROCAR_HAS_OPENSSL
  if (endpoint.is_secure)
    return base::Error{base::ErrorCode::kXapiUnsafe,
                       "this build has no https; build it with libssl-dev installed"};
#endif
  return endpoint;
}

base::Result<HttpAnswer> PostStatement(const Endpoint& endpoint, const std::string& statement,
                                       const std::string& credentials, double seconds) {
  const std::chrono::duration<double> most(seconds);
  try {
    asio::io_context context;
    const auto request = MakeRequest(endpoint, statement, credentials);
#if TROCAR_HAS_OPENSSL
    if (endpoint.is_secure) return PostSecurely(context, endpoint, request, most);
#endif
    beast::tcp_stream stream(context);
    if (auto connected = Connect(context, stream, endpoint, most); !connected.ok()) return connected.error();
    return Exchange(context, stream, endpoint, request, most);
  } catch (const std::exception& failure) {
    return Away(endpoint, failure.what());
  }
}

}  // namespace trocar::report
